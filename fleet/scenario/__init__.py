"""Scenarios: what one run is made of, from a TOML file, the command line or Python."""
