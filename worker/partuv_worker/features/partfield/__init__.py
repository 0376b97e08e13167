"""PartField inference (Liu et al. 2025): 448 part features for every point of a surface.

Importing a module of this package other than `shape` imports torch; nothing outside the PartField
prior does so.
"""
