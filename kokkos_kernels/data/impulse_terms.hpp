#pragma once
// The numbers that friction keeps of the normal impulses at a node.

namespace mpm {

/// Numbers of one rigid body at a node, of which each step keeps a part: the sum of normal impulses over the
/// nodal mass, by weight [m/s], the sum of the weights [-], and the normal impulse that friction has not used
/// [N s].
struct ImpulseTerms {
  static constexpr int sum = 0, weight = 1, store = 2, size = 3;
};

}  // namespace mpm
