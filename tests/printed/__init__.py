"""Compares numbers in README, pages and headers of cases with runs of the program."""
