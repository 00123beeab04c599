#pragma once

#include <string>

namespace peristat {

/// "; numbers carry no unit: …" if the text is a number with a unit behind it ("3.2 GPa"), which
/// case files don't allow; otherwise empty.
[[nodiscard]] std::string remark_on_unit(const std::string& text);

}  // namespace peristat
