"""Results as plain arrays, as a netCDF-4 file with CF-1.11 attributes, and as an xarray Dataset.

The run path writes with netCDF4 alone; xarray is imported only to read, compare and plot.
"""
