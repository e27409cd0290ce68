/* A linear elastic UMAT in C that keeps what it is given in statev, so that a test can hold it against what
 * it must be, and that gives up when a parameter says so.
 *
 * props   0 Young's modulus [Pa], 1 Poisson's ratio, 2 what it does when the strain 11 or 22 passes props[3]:
 * 0 nothing, 1 pnewdt below 1, 2 xit, 3 a stress that is not a number; 4 at once: xit; 5 at once: no
 * stiffness; when the strain passes: 6 exit(0), 7 _exit(0), 8 quick_exit(0), 9 statev 1 that is not a number,
 * 10 sse that is infinite; 11 at once: exit(0) statev  0 noel, 1 time, 2 dtime, 3 to 5 coords, 6 to 14 drot
 * by columns, 15 to 20 stran and dstran added up in Abaqus' order, 21 ntens, 22 celent, 23 kinc, 24 first
 * letter of cmname, 25 calls, 26 to 34 dfgrd1 by columns, 35 layer + kspt + npt + jstep, 36 nstatv, 37
 * rotations of statev 15 to 20 by rotsig, against stran: largest misfit */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

void xit_(void);
void rotsig_(const double* s, const double* r, double* turned, const int* lstr, const int* ndi,
             const int* nshr);
void stdb_abqerr_(const int* lop, const char* format, const int* intv, const double* realv, const char* charv,
                  size_t format_length, size_t charv_length);

static void give_up(int how, double* stress, double* pnewdt) {
  const int stop = -3, step = 7;
  const double strain = 0.25;
  const char* message = "strain %R in step %I of %S";
  if (how == 1) *pnewdt = 0.5;
  if (how == 2) stdb_abqerr_(&stop, message, &step, &strain, "probe   ", 26, 8);
  if (how == 3) stress[0] = NAN;
  if (how == 6) exit(0);
  if (how == 7) _exit(0);
  if (how == 8) quick_exit(0);
}

void umat(double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd, double* rpl,
          double* ddsddt, double* drplde, double* drpldt, const double* stran, const double* dstran,
          const double* time, const double* dtime, const double* temp, const double* dtemp,
          const double* predef, const double* dpred, const char* cmname, const int* ndi, const int* nshr,
          const int* ntens, const int* nstatv, const double* props, const int* nprops, const double* coords,
          const double* drot, double* pnewdt, const double* celent, const double* dfgrd0,
          const double* dfgrd1, const int* noel, const int* npt, const int* layer, const int* kspt,
          const int* jstep, const int* kinc) {
  const double young = props[0], poisson = props[1];
  const double shear = young / (2 * (1 + poisson)),
               lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const int n = *ntens, how = *nprops > 2 ? (int)props[2] : 0, strain_type = 2;
  if (how == 4) xit_();
  if (how == 11) exit(0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n && how != 5; ++i)
      ddsdde[i + n * j] = (i < 3 && j < 3 ? lame : 0) + (i != j ? 0 : i < 3 ? 2 * shear : shear);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) stress[i] += ddsdde[i + n * j] * dstran[j];
  if (*nstatv >= 38) {
    double turned[6];
    rotsig_(statev + 15, drot, turned, &strain_type, ndi, nshr);
    for (int i = 0; i < n; ++i) {
      statev[37] = fmax(statev[37], fabs(turned[i] - stran[i]));
      statev[15 + i] = turned[i] + dstran[i];
    }
    statev[0] = *noel, statev[1] = time[0], statev[2] = *dtime;
    for (int d = 0; d < 3; ++d) statev[3 + d] = coords[d];
    for (int k = 0; k < 9; ++k) statev[6 + k] = drot[k], statev[26 + k] = dfgrd1[k];
    statev[21] = n, statev[22] = *celent, statev[23] = *kinc, statev[24] = cmname[0], statev[25] += 1;
    statev[35] = *layer + *kspt + *npt + *jstep, statev[36] = *nstatv;
  }
  if (how > 0 && how < 11 && fmax(fabs(stran[0] + dstran[0]), fabs(stran[1] + dstran[1])) > props[3]) {
    give_up(how, stress, pnewdt);
    if (how == 9) statev[1] = NAN;
    if (how == 10) *sse = INFINITY;
  }
}
