#pragma once
// A shared library with a subroutine UMAT, as users of Abaqus write it, and how it is called.

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace mpm {

/// Arguments of one call of a UMAT, in and out. Abaqus' order 11 22 33 12 13 23, engineering shear strains,
/// tension positive; in 2D the first four.
struct UmatCall {
  double stress[6] = {};            // Pa, turned with the material already
  double strain[6] = {};            // -, total strain before the step, turned likewise
  double strain_increment[6] = {};  // -
  double energy[3] = {};            // J/m3, SSE SPD SCD
  double rotation[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // DROT
  double gradient[3][3] = {};                                 // -, of the step's displacement
  double time = 0, dt = 0;                                    // s, at the start of the step
  double position[3] = {};                                    // m
  int id = 0;                                                 // of the particle, from 0
  bool at_start = false;  // before the first step, while the input is checked
  double modulus = 0;     // Pa, result: largest normal stiffness of DDSDDE
  bool gave_up = false;   // result: PNEWDT below 1, or XIT
};

/// An open library. Threads may share it.
struct UmatLibrary {
  std::shared_ptr<void> handle;  // of dlopen
  void* umat = nullptr;          // umat_ or umat
  void* sdvini = nullptr;        // sdvini_ or sdvini; null where there is none
  std::string material;          // CMNAME: in capitals, filled to 80 characters
  std::string name, path;        // of the material, of the file, as the user gave them
  std::vector<double> properties, state_start;
  int dim = 2;
  std::array<double, 3> lower{};  // m, lower corner of the mesh
  double spacing = 1;             // m, edge of the mesh's cells, CELENT

  /// Calls UMAT. on_threads: it may run on several threads at once; else calls wait for one another.
  void call(UmatCall& call, double* states, int count, bool on_threads) const;
  /// State variables of a particle at the start: state_start, or what SDVINI sets, which may give up.
  void start(UmatCall& at, double* states, int count, bool on_threads) const;
};

/// Texts of the options library, properties and state_start; the latter two are lists of numbers.
struct UmatTexts {
  std::string library, properties, state_start;
};

/// Opens a library. Where it, or later its UMAT, ends the program (exit, STOP of Fortran, _exit), the status
/// becomes 2 before the first step and 3 after it, and a line on stderr reports it. If the library cannot be
/// used, the result is null, `key` is the option to change, and `takes` the end of the message "takes ...".
std::shared_ptr<const UmatLibrary> open_umat(const std::string& material, const UmatTexts& texts, int dim,
                                             const std::array<double, 3>& lower, double spacing,
                                             std::string& key, std::string& takes);

/// Exception that XIT throws through the frames of a UMAT to the call that it ends.
struct UmatExit {};

}  // namespace mpm
