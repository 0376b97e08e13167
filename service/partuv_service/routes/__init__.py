"""The REST interface: one file per group of addresses, each route a few lines."""
