// The utility routines of Abaqus that UMATs call, with the names and arguments that Fortran gives them.
// umat_symbols.txt lists them, so that a library that is loaded finds them in the program.

#include "physics/materials/umat_utilities.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <string>

#include <unistd.h>

#include "physics/materials/umat_library.hpp"

namespace {

using Matrix3 = double[3][3];

constexpr int k_strain = 2;  // LSTR: engineering shear strains; else a stress

/// Components in Abaqus' order, NDI normal ones and NSHR of 12 13 23, as a tensor.
void unpack(const double* s, int lstr, int ndi, int nshr, Matrix3& t) {
  constexpr int k_place[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (auto& row : t)
    for (double& x : row) x = 0;
  for (int k = 0; k < ndi; ++k) t[k][k] = s[k];
  for (int k = 0; k < nshr; ++k) {
    const auto [i, j] = k_place[k];
    t[i][j] = t[j][i] = lstr == k_strain ? s[ndi + k] / 2 : s[ndi + k];
  }
}

void pack(const Matrix3& t, int lstr, int ndi, int nshr, double* s) {
  const double shear[3] = {t[0][1], t[0][2], t[1][2]};
  for (int k = 0; k < ndi; ++k) s[k] = t[k][k];
  for (int k = 0; k < nshr; ++k) s[ndi + k] = lstr == k_strain ? 2 * shear[k] : shear[k];
}

/// Turns the plane (p, q) so that t[p][q] is 0 (Jacobi 1846; Golub & Van Loan, 8.5); row k of `axis` is the
/// axis of t[k][k].
void turn(Matrix3& t, Matrix3& axis, int p, int q) {
  if (t[p][q] == 0) return;
  const double tau = (t[q][q] - t[p][p]) / (2 * t[p][q]);
  const double tangent = std::copysign(1, tau) / (std::fabs(tau) + std::hypot(1, tau));
  const double c = 1 / std::hypot(1, tangent), s = tangent * c;
  for (int k = 0; k < 3; ++k) {
    const double a = t[k][p], b = t[k][q];
    t[k][p] = c * a - s * b, t[k][q] = s * a + c * b;
  }
  for (int k = 0; k < 3; ++k) {
    const double a = t[p][k], b = t[q][k];
    t[p][k] = c * a - s * b, t[q][k] = s * a + c * b;
    const double x = axis[p][k], y = axis[q][k];
    axis[p][k] = c * x - s * y, axis[q][k] = s * x + c * y;
  }
  t[p][q] = t[q][p] = 0;
}

/// Principal values in descending order; row k of `axis` is the direction of value k.
void principal(Matrix3& t, double* values, Matrix3& axis) {
  constexpr int k_sweeps = 12;  // they converge quadratically
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) axis[i][j] = i == j;
  for (int n = 0; n < k_sweeps && (t[0][1] != 0 || t[0][2] != 0 || t[1][2] != 0); ++n)
    turn(t, axis, 0, 1), turn(t, axis, 0, 2), turn(t, axis, 1, 2);
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int a, int b) { return t[a][a] > t[b][b]; });
  Matrix3 sorted;
  for (int k = 0; k < 3; ++k) {
    values[k] = t[order[k]][order[k]];
    std::copy_n(axis[order[k]], 3, sorted[k]);
  }
  std::memcpy(axis, sorted, sizeof sorted);
}

/// Puts a text into a text of Fortran, which blanks fill.
void to_fortran(const std::string& text, char* out, int* length, std::size_t room) {
  *length = static_cast<int>(std::min(text.size(), room));
  std::fill_n(out, room, ' ');
  std::copy_n(text.begin(), *length, out);
}

/// A text of Fortran without the blanks at its end.
std::string from_fortran(const char* text, std::size_t length) {
  while (length > 0 && text[length - 1] == ' ') --length;
  return {text, length};
}

std::mutex& mutex_of(int id) {
  constexpr int k_mutexes = 100;  // as Abaqus has
  static std::mutex mutexes[k_mutexes];
  return mutexes[std::clamp(id, 1, k_mutexes) - 1];
}

}  // namespace

extern "C" {

/// SINV1: mean of the normal stresses; SINV2: Mises' stress sqrt(3/2 s:s) of the deviator s.
void sinv_(const double* stress, double* sinv1, double* sinv2, const int* ndi, const int* nshr) {
  Matrix3 t;
  unpack(stress, 1, *ndi, *nshr, t);
  const double mean = (t[0][0] + t[1][1] + t[2][2]) / 3;
  double square = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double s = t[i][j] - (i == j ? mean : 0);
      square += s * s;
    }
  *sinv1 = mean, *sinv2 = std::sqrt(1.5 * square);
}

/// Principal values of a stress (LSTR = 1) or a strain (LSTR = 2).
void sprinc_(const double* s, double* ps, const int* lstr, const int* ndi, const int* nshr) {
  Matrix3 t, axis;
  unpack(s, *lstr, *ndi, *nshr, t);
  principal(t, ps, axis);
}

/// Principal values with their directions: AN(K, I) is component I of the direction of PS(K).
void sprind_(const double* s, double* ps, double* an, const int* lstr, const int* ndi, const int* nshr) {
  Matrix3 t, axis;
  unpack(s, *lstr, *ndi, *nshr, t);
  principal(t, ps, axis);
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) an[k + 3 * i] = axis[k][i];
}

/// SPRIME = R S R^T of a stress (LSTR = 1) or a strain (LSTR = 2); with R = DROT, as the material turns.
void rotsig_(const double* s, const double* r, double* sprime, const int* lstr, const int* ndi,
             const int* nshr) {
  Matrix3 t, turned;
  unpack(s, *lstr, *ndi, *nshr, t);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = 0;
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) sum += r[i + 3 * k] * t[k][l] * r[j + 3 * l];
      turned[i][j] = sum;
    }
  pack(turned, *lstr, *ndi, *nshr, sprime);
}

/// Ends the call of the UMAT; the run then ends with exit status 3.
void xit_() { throw mpm::UmatExit{}; }

/// A message to stderr, in which %I, %R and %S stand for the next whole number, number and text of 8
/// characters. LOP -3 ends the call as XIT does.
void stdb_abqerr_(const int* lop, const char* format, const int* intv, const double* realv, const char* charv,
                  std::size_t format_length, std::size_t) {
  std::string line;
  const std::string text = from_fortran(format, format_length);
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char kind = text[k] == '%' && k + 1 < text.size() ? text[k + 1] : ' ';
    if (kind == 'I')
      line += std::to_string(*intv++), ++k;
    else if (kind == 'S')
      line += from_fortran(charv, 8), charv += 8, ++k;
    else if (kind == 'R') {
      char number[32];
      std::snprintf(number, sizeof number, "%.9g", *realv++);
      line += number, ++k;
    } else
      line += text[k];
  }
  std::fprintf(stderr, "umat: %s\n", line.c_str());
  if (*lop == -3) xit_();
}

/// The working folder of the run, and its length.
void getoutdir_(char* outdir, int* length, std::size_t room) {
  char folder[4096];
  to_fortran(getcwd(folder, sizeof folder) != nullptr ? folder : ".", outdir, length, room);
}

void getjobname_(char* name, int* length, std::size_t room) { to_fortran("mpm", name, length, room); }

void mutexinit_(const int*) {}
void mutexlock_(const int* id) { mutex_of(*id).lock(); }
void mutexunlock_(const int* id) { mutex_of(*id).unlock(); }

}  // extern "C"

namespace mpm {

void keep_umat_utilities() {}

}  // namespace mpm
