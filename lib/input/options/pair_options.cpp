// Contact between rigid bodies.

#include "input/options/groups.hpp"

namespace mpm {

void read_rigid_contact(OptionReader& in, Config& config) {
  const Option contact{.name = "rigid_contact",
                       .meaning =
                           "whether rigid bodies touch each other, where one of two is dynamic, and dynamic "
                           "ones the sides of the mesh that are not free"},
      friction{.name = "rigid_friction",
               .meaning =
                   "Coulomb coefficient between rigid bodies, of all pairs; else the smaller of the "
                   "two -NAME_friction, or that of the one that has it",
               .unit = "-",
               .range = {.lowest = 0, .highest = 10},
               .standard = "by the bodies"};
  std::string table;  // the deck has its rows already
  in.text({.name = "rigid_bodies_file",
           .meaning =
               "CSV file of rigid bodies beside -rigid_bodies: a line of keys, first name, and a row for "
               "each body, whose cell of a key KEY is -NAME_KEY where no deck gives it; blanks between the "
               "numbers of a list"},
          table);
  if (config.rigids.empty() && !in.listing()) {
    for (const Option* option : {&contact, &friction})
      in.not_taken(option->name, "there are no -rigid_bodies");
    return;
  }
  config.rigid_contact_given = in.given(contact.name);
  const auto bodies = in.where("rigid_bodies");
  in.word(contact, Words<bool>{{"on", true}, {"off", false}}, config.rigid_contact);
  if (const auto only = in.where(contact.name, {"on"}); config.rigid_contact || in.listing())
    in.number(friction, config.rigid_friction);
  else
    in.not_taken(friction.name, "-rigid_contact is off");
}

void read_restitution(OptionReader& in, RigidConfig& rigid) {
  in.number(
      {.name = rigid.name + "_restitution",
       .meaning = "velocity of parting over that of approach in an impact on another rigid body or a side of "
                  "the mesh; a pair takes the smaller of the two, or that of the one that has it",
       .unit = "-",
       .range = {.lowest = 0, .highest = 1},
       .standard = "0"},
      rigid.restitution);
}

}  // namespace mpm
