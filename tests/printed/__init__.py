"""Compares the numbers that README, pages and headers of cases print with runs of the program."""
