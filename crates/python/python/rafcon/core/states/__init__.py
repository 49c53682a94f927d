"""The kinds of states; one module for each, as state machine files name them."""
