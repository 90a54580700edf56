"""Scenes at random, what the program says about them, and what is true. README.md in the folder above says how to run it."""
