"""A dataset file as figures read it: values by name at once, and xarray where they ask for more.

Importing xarray, and pandas with it, takes longer than solving and drawing a case.  Most figures ask a dataset for
values, dimensions, attributes and single cases only, which is answered here; all else is asked of the same in xarray.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from rockcli.storage import netcdf
from rockcli.storage.contents import Contents, Field
from rockcli.storage.read import assembled

if TYPE_CHECKING:
    import xarray


def open_lazily(path: Path) -> xarray.Dataset:
    """Read a dataset file whole, without xarray; `StudyError` if it cannot be read."""
    return lazily(netcdf.read(path))


def lazily(contents: Contents) -> xarray.Dataset:
    """What a dataset holds, or will hold, without xarray."""
    return cast("xarray.Dataset", LazyDataset(contents.fields, contents.attrs | contents.named_axes))


class LazyArray(NDArrayOperatorsMixin):
    """Stands for an xarray.DataArray: values over named dimensions, with attributes."""

    def __init__(self, name: str, item: Field) -> None:
        self.name, self.dims, self.values, self.attrs = name, item.dims, item.values, item.attrs
        self._item = item

    dtype = property(lambda self: self.values.dtype)
    shape = property(lambda self: self.values.shape)
    ndim = property(lambda self: self.values.ndim)
    size = property(lambda self: self.values.size)

    @cached_property
    def as_xarray(self) -> xarray.DataArray:
        """The same in xarray, but for its coordinates."""
        import xarray

        return xarray.DataArray(self.values, dims=self.dims, name=self.name, attrs=self.attrs)

    def isel(self, at: Mapping[Any, Any] | None = None, **more: Any) -> LazyArray:
        """Parts of dimensions: the place of a point, or several places."""
        return LazyArray(self.name, _part(self._item, {**(at or {}), **more}))

    def transpose(self, *dims: Any) -> LazyArray:
        """The dimensions in this order; `...` stands for the others."""
        others = [dim for dim in self.dims if dim not in dims]
        order = [dim for each in dims for dim in (others if each is ... else [each])] or self.dims[::-1]
        values = self.values.transpose([self.dims.index(dim) for dim in order])
        return LazyArray(self.name, Field(tuple(order), values, self.attrs))

    def copy(self, deep: bool = True, data: NDArray[Any] | None = None) -> LazyArray:
        """The same, or other values over the same dimensions."""
        own = self.values.copy() if deep else self.values
        return LazyArray(self.name, Field(self.dims, own if data is None else data, self.attrs))

    def __bool__(self) -> bool:
        return bool(self.values)

    def __int__(self) -> int:
        return int(self.values)

    def __float__(self) -> float:
        return float(self.values)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, at: Any) -> Any:
        return self.as_xarray[at]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.values, dtype=dtype, copy=copy)

    def __array_ufunc__(self, function: np.ufunc, method: str, *of: Any, **how: Any) -> Any:
        of = tuple(each.as_xarray if isinstance(each, LazyArray) else each for each in of)
        return getattr(function, method)(*of, **how)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.as_xarray, name)


class LazyDataset:
    """Stands for an xarray.Dataset: variables by name, and attributes."""

    def __init__(self, fields: Mapping[str, Field], attrs: Mapping[str, Any]) -> None:
        self._fields, self.attrs = dict(fields), dict(attrs)

    @cached_property
    def as_xarray(self) -> xarray.Dataset:
        """The same in xarray."""
        return assembled(self._fields, self.attrs)

    @property
    def variables(self) -> dict[str, LazyArray]:
        """All of them."""
        return {name: LazyArray(name, item) for name, item in self._fields.items()}

    @property
    def coords(self) -> dict[str, LazyArray]:
        """Those that are coordinates."""
        return {name: item for name, item in self.variables.items() if self._fields[name].coordinate}

    @property
    def data_vars(self) -> dict[str, LazyArray]:
        """Those that are not."""
        return {name: item for name, item in self.variables.items() if not self._fields[name].coordinate}

    @property
    def sizes(self) -> dict[str, int]:
        """Length of every dimension."""
        return {
            dim: size for item in self._fields.values() for dim, size in zip(item.dims, item.values.shape, strict=True)
        }

    dims = sizes

    def isel(self, at: Mapping[Any, Any] | None = None, **more: Any) -> LazyDataset:
        """Parts of dimensions: the place of a point, or several places."""
        chosen = {**(at or {}), **more}
        return LazyDataset({name: _part(item, chosen) for name, item in self._fields.items()}, self.attrs)

    def __getitem__(self, name: str) -> LazyArray:
        return LazyArray(name, self._fields[name])

    def __contains__(self, name: str) -> bool:
        return name in self._fields

    def __iter__(self) -> Iterator[str]:
        return iter(self.data_vars)

    def __len__(self) -> int:
        return len(self.data_vars)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.as_xarray, name)


def _part(item: Field, chosen: Mapping[str, Any]) -> Field:
    """A field at places of those of its dimensions that are named; a single place takes the dimension away."""
    values, dims = item.values, item.dims
    for dim in set(dims) & chosen.keys():
        before = values.ndim
        values = np.asarray(values[(slice(None),) * dims.index(dim) + (chosen[dim],)])
        if values.ndim < before:
            dims = tuple(each for each in dims if each != dim)
    return Field(dims, values, item.attrs, item.coordinate)
