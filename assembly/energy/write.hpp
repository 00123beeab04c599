#pragma once

namespace peristat {

/// Whether a pass overwrites what its result held or adds to it.
enum class Write { over, onto };

}  // namespace peristat
