#pragma once
// The numbers that a particle keeps of the surface of a load.

namespace mpm {

/// Places of the numbers of one load (data/surface_loads.hpp): its area as a vector out of the soil [m2]; the
/// area at the start [m2], and over it the size of the vector then, which is more than 1 where the surface
/// goes in steps of particles; and the number of the load, from 1 on, 0 where there is none.
struct FacePlaces {
  int area, start, steps, load, size;
};
constexpr FacePlaces face_places(int dim) { return {0, dim, dim + 1, dim + 2, dim + 3}; }

/// Places for a dimension that the program is compiled for.
template <int Dim>
struct FaceTerms {
  static constexpr int area = face_places(Dim).area, start = face_places(Dim).start,
                       steps = face_places(Dim).steps, load = face_places(Dim).load,
                       size = face_places(Dim).size;
};

inline constexpr int k_most_faces = 3;  // of a particle

}  // namespace mpm
