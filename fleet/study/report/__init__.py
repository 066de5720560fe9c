"""The report of a study: figures and tables chosen from what it varies."""
