"""Small helpers that scripts import: logging, constants, nested dictionaries."""
