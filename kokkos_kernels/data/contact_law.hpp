#pragma once
// Law of a contact of the soil.

namespace mpm {

/// Properties of the interface between the soil and what it touches.
struct ContactLaw {
  bool at_sites;          // contact at sites, not at nodes
  bool separates;         // the soil may part from it
  bool permeable;         // water in the pores of the soil passes it
  double reach;           // m, gap at which the contact ends; 0: it does not depend on the gap
  double exponent;        // -, of its decrease with the gap
  double shear_limit;     // Pa, infinite where only the friction limits
  double shear_fraction;  // -, of the soil's strength instead of the limit; negative: none
  double friction;        // -, negative: none
};

}  // namespace mpm
