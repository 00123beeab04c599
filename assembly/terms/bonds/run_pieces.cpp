#include "assembly/terms/bonds/run_pieces.hpp"

#include <utility>

namespace peristat {

RunPieces::RunPieces(std::vector<BondRun> runs) : runs_(std::move(runs)) {}

}  // namespace peristat
