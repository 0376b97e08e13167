"""Packing the charts that an asset has already, without making new ones."""
