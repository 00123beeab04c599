"""The pictures of the program: figures made from a results folder, and the command that saves them."""
