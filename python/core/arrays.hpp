#pragma once

#include <vector>

#include <pybind11/numpy.h>

namespace peristat::python {

/// A view of numbers of C++ that can't be written, without a copy. It keeps `owner` alive.
template <class Number>
pybind11::array_t<Number> view_of(const Number* numbers, std::vector<pybind11::ssize_t> shape,
                                  pybind11::handle owner) {
  pybind11::array_t<Number> view(std::move(shape), numbers, owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}

/// An array of its own. The shape has as many places as there are numbers.
template <class Number>
pybind11::array_t<Number> copy_of(const Number* numbers, std::vector<pybind11::ssize_t> shape) {
  return pybind11::array_t<Number>(std::move(shape), numbers);
}

}  // namespace peristat::python
