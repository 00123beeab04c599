"""Fits keys of cases to measured curves by least squares (docs/fit.md)."""
