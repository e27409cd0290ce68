/* Elastic, perfectly plastic clay with yield at sqrt(J2) = su and radial return, as a UMAT in C. It gives the stresses of
 * the model von_mises.
 *
 * props   0 Young's modulus [Pa], 1 Poisson's ratio, 2 undrained shear strength su [Pa]
 * statev  0 plastic engineering shear strain
 *
 * All arguments are pointers, as Fortran passes them; matrices go column by column. */
#include <math.h>

void xit_(void);

void umat(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, double *ddsddt,
          double *drplde, double *drpldt, const double *stran, const double *dstran, const double *time, const double *dtime,
          const double *temp, const double *dtemp, const double *predef, const double *dpred, const char *cmname,
          const int *ndi, const int *nshr, const int *ntens, const int *nstatv, const double *props, const int *nprops,
          const double *coords, const double *drot, double *pnewdt, const double *celent, const double *dfgrd0,
          const double *dfgrd1, const int *noel, const int *npt, const int *layer, const int *kspt, const int *jstep,
          const int *kinc) {
  if (*nprops != 3 || *nstatv < 1 || *ndi != 3) xit_();
  const double young = props[0], poisson = props[1], su = props[2];
  const double shear = young / (2 * (1 + poisson)), lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const int n = *ntens;

  /* The program takes the fastest wave from the stiffness, so it is the elastic one. */
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      ddsdde[i + n * j] = (i < 3 && j < 3 ? lame : 0) + (i != j ? 0 : i < 3 ? 2 * shear : shear);

  const double volume = dstran[0] + dstran[1] + dstran[2];
  for (int i = 0; i < n; ++i) stress[i] += i < 3 ? lame * volume + 2 * shear * dstran[i] : shear * dstran[i];

  const double mean = (stress[0] + stress[1] + stress[2]) / 3;
  double j2 = 0;
  for (int i = 0; i < n; ++i) j2 += i < 3 ? (stress[i] - mean) * (stress[i] - mean) / 2 : stress[i] * stress[i];
  const double size = sqrt(j2);
  if (size > su) {
    const double share = su / size;
    for (int i = 0; i < n; ++i) stress[i] = i < 3 ? mean + share * (stress[i] - mean) : share * stress[i];
    statev[0] += (size - su) / shear;
    *spd += su * (size - su) / shear;
  }
  const double left = fmin(size, su);
  *sse = mean * mean / (2 * lame + 4 * shear / 3) + left * left / (2 * shear);
}
