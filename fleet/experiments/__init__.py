"""Studies with a report of their own: they use the library, and the library never imports them."""
