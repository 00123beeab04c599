#include "cases/runner/process/time_left.hpp"

#include <cstddef>

namespace peristat {
namespace {

constexpr std::size_t most_moments = 9, least_moments = 4;

}  // namespace

void TimeLeft::accepted(double seconds, double share, bool damaged) {
  if (damaged) {
    last_.clear();
    return;
  }
  last_.push_back({seconds, share});
  if (last_.size() > most_moments) last_.pop_front();
}

std::optional<double> TimeLeft::seconds() const {
  if (last_.size() < least_moments) return {};
  const Moment &end = last_.back(), &middle = last_[last_.size() / 2];
  const auto rate_since = [&](const Moment& since) {
    return (end.share - since.share) / (end.seconds - since.seconds);
  };
  const double whole = rate_since(last_.front()), recent = rate_since(middle);
  // Written so that NaN, from steps that took no time, gives no estimate either.
  if (!(whole > 0.0 && recent > 0.5 * whole && recent < 2.0 * whole)) return {};
  return (1.0 - end.share) / recent;
}

}  // namespace peristat
