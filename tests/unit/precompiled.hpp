// Precompiled for the unit tests, which are many and small: what nearly all of them include.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"
