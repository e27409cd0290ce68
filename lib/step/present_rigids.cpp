#include "step/present_rigids.hpp"

#include <algorithm>
#include <cmath>

namespace mpm {
namespace {

/// Rows of `head` numbers and then `width` numbers a rigid, of some rigids, as rows of others: the numbers of
/// rigid from[k] go to rigid to[k], and all others are 0.
std::vector<double> rearranged(const std::vector<double>& rows, std::size_t head, std::size_t width,
                               std::size_t before, std::size_t after, const std::vector<std::size_t>& from,
                               const std::vector<std::size_t>& to) {
  const std::size_t length = head + width * before, now = head + width * after;
  if (length == 0 || rows.size() % length != 0) return rows;  // those of a file that somebody has altered
  std::vector<double> out(rows.size() / length * now);
  for (std::size_t n = 0; n < rows.size() / length; ++n) {
    const double* const row = &rows[n * length];
    std::copy_n(row, head, &out[n * now]);
    for (std::size_t k = 0; k < from.size(); ++k)
      std::copy_n(row + head + width * from[k], width, &out[n * now + head + width * to[k]]);
  }
  return out;
}

/// Rows of `width` numbers, which begin with the numbers of so many bodies, for bodies with other numbers:
/// number n becomes to[n]. Rows of a body whose to[n] < 0 are left out; sides, whose numbers are negative,
/// stay.
std::vector<double> renumbered(const std::vector<double>& rows, std::size_t width, std::size_t bodies,
                               const std::vector<long>& to) {
  std::vector<double> out;
  const auto now = [&](double n) {
    const auto known = n >= 0 && n < static_cast<double>(to.size());
    return n < 0 ? n : known ? static_cast<double>(to[static_cast<std::size_t>(n)]) : -1;
  };
  for (std::size_t at = 0; at + width <= rows.size(); at += width) {
    std::vector<double> row(rows.begin() + static_cast<long>(at),
                            rows.begin() + static_cast<long>(at + width));
    bool left_out = false;
    for (std::size_t k = 0; k < bodies; ++k) {
      left_out = left_out || (row[k] >= 0 && now(row[k]) < 0);
      row[k] = now(row[k]);
    }
    if (!left_out) out.insert(out.end(), row.begin(), row.end());
  }
  return out;
}

std::vector<double> contacts_of_others(const std::vector<double>& contacts, const std::vector<long>& to) {
  return renumbered(contacts, SavedPairs::width, 2, to);
}
std::vector<double> parts_of_others(const std::vector<double>& parts, const std::vector<long>& to) {
  return renumbered(parts, PartTerms::size, 1, to);
}

/// 0, 1, ...
std::vector<std::size_t> counted(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  for (std::size_t k = 0; k < count; ++k) numbers[k] = k;
  return numbers;
}

}  // namespace

PresentRigids::PresentRigids(const Config& config) : others_(config.rigids.size()) {
  for (std::size_t r = 0; r < config.rigids.size(); ++r) {
    names_.push_back(config.rigids[r].name);
    if (!config.rigids[r].absent) place_.push_back(r);
  }
}

Config PresentRigids::narrowed(const Config& config) const {
  Config out = config;
  std::erase_if(out.rigids, [](const RigidConfig& rigid) { return rigid.absent; });
  for (JointConfig& joint : out.joints) {
    bool is_there = true;
    for (int& body : joint.bodies) {
      if (body == JointConfig::k_ground) continue;
      const auto found = std::find(place_.begin(), place_.end(), static_cast<std::size_t>(body));
      is_there = is_there && found != place_.end();
      body = static_cast<int>(found - place_.begin());
    }
    if (!is_there) joint.bodies = {JointConfig::k_ground, JointConfig::k_ground};
  }
  return out;
}

void PresentRigids::narrow(SavedState& state) {
  if (all() || state.rigids.size() != others_.size()) return;  // the reader of checkpoints reports the latter
  const std::vector<std::size_t> here = counted(place_.size());
  others_ = state.rigids;
  state.impulse.values = rearranged(state.impulse.values, 0, numbers_of_rigid(state.impulse, others_.size()),
                                    others_.size(), place_.size(), place_, here);
  state.bounds = rearranged(state.bounds, k_saved_bounds, MotionTerms::impulse_size, others_.size(),
                            place_.size(), place_, here);
  state.pairs.impulses =
      rearranged(state.pairs.impulses, 0, SavedPairs::totals, others_.size(), place_.size(), place_, here);
  std::vector<long> number(others_.size(), -1);
  for (std::size_t k = 0; k < place_.size(); ++k) number[place_[k]] = static_cast<long>(k);
  state.pairs.contacts = contacts_of_others(state.pairs.contacts, number);
  state.part_impulses = parts_of_others(state.part_impulses, number);
  state.supports =
      rearranged(state.supports, 0, SupportTerms::size, others_.size(), place_.size(), place_, here);
  state.rigids.clear();
  for (const std::size_t r : place_) state.rigids.push_back(others_[r]);
}

void PresentRigids::widen(SavedState& state) const {
  if (all()) return;
  const std::vector<std::size_t> here = counted(place_.size());
  state.impulse.values =
      place_.empty() ? std::vector<double>(ImpulseTerms::size * state.impulse.address.size() * others_.size())
                     : rearranged(state.impulse.values, 0, numbers_of_rigid(state.impulse, place_.size()),
                                  place_.size(), others_.size(), here, place_);
  state.bounds = rearranged(state.bounds, k_saved_bounds, MotionTerms::impulse_size, place_.size(),
                            others_.size(), here, place_);
  state.pairs.impulses =
      rearranged(state.pairs.impulses, 0, SavedPairs::totals, place_.size(), others_.size(), here, place_);
  const std::vector<long> places(place_.begin(), place_.end());
  state.pairs.contacts = contacts_of_others(state.pairs.contacts, places);
  state.part_impulses = parts_of_others(state.part_impulses, places);
  state.supports =
      rearranged(state.supports, 0, SupportTerms::size, place_.size(), others_.size(), here, place_);
  std::vector<SavedRigid> rigids = others_;
  for (std::size_t k = 0; k < place_.size(); ++k) rigids[place_[k]] = state.rigids[k];
  state.rigids = std::move(rigids);
}

void PresentRigids::widen(std::vector<RigidRow>& rows) const {
  if (all()) return;
  std::vector<RigidRow> out(others_.size());
  for (std::size_t r = 0; r < others_.size(); ++r)
    out[r].displacement = vector_of(others_[r], MotionTerms::displacement);
  for (std::size_t k = 0; k < place_.size(); ++k) out[place_[k]] = rows[k];
  rows = std::move(out);
}

void PresentRigids::widen(std::vector<ParticleSnapshot>& groups) const {
  if (all()) return;
  std::vector<ParticleSnapshot> out(others_.size());
  for (std::size_t r = 0; r < others_.size(); ++r) out[r].name = names_[r];
  for (std::size_t k = 0; k < place_.size(); ++k) out[place_[k]] = std::move(groups[k]);
  groups = std::move(out);
}

}  // namespace mpm
