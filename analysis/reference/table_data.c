/* Tables that a run needs without any file. Where they come from: data/README.md. */
#include "reference.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

/* Rotating square patch, data/square_patch_evolution.csv. */
static const double patch_time[] = {
  0.00, 0.05, 0.10, 0.15, 0.20, 0.25, 0.30, 0.35, 0.40, 0.45, 0.50, 0.55, 0.60,
  0.65, 0.70, 0.75, 0.80, 0.85, 0.90, 0.95, 1.00, 1.05, 1.10, 1.15, 1.20, 1.25,
  1.30, 1.40, 1.50, 1.60, 1.70, 1.80, 1.90, 2.00, 2.10, 2.20, 2.30, 2.40,
};
static const double patch_p_centre[] = {
  -0.14734270656, -0.14718283342, -0.14670523795, -0.14591599566, -0.14482521695, -0.14344694262,
  -0.14179888282, -0.13990196484, -0.13777970559, -0.13545746690, -0.13296167036, -0.13031904478,
  -0.12755595932, -0.12469787176, -0.12176890026, -0.11879151228, -0.11578631654, -0.11277194099,
  -0.10976498034, -0.10677999849, -0.10382957399, -0.10092437862, -0.09807328122, -0.09528347044,
  -0.09256059063, -0.08990888622, -0.08733134762, -0.08240540445, -0.07778725524, -0.07347044263,
  -0.06944128215, -0.06568187975, -0.06217240890, -0.05889573456, -0.05582781940, -0.05295524194,
  -0.05026174799, -0.04773454238,
};
static const double patch_p_centre_error[] = {
  1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10,
  1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 1e-10, 5e-09, 5e-09, 5e-09,
  5e-09, 1e-08, 1e-08, 1e-08, 2e-07, 5e-07, 2e-05, 5e-06, 3e-05, 3e-05, 2e-04, 2e-04,
};
static const double patch_r_min[] = {
  0.500000000, 0.499781119, 0.499127582, 0.498048457, 0.496558072, 0.494674991, 0.492420860,
  0.489819276, 0.486894813, 0.483672256, 0.480176072, 0.476430073, 0.472457241, 0.468279661,
  0.463918522, 0.459394143, 0.454726021, 0.449932858, 0.445032579, 0.440042336, 0.434978486,
  0.429856567, 0.424691258, 0.419496337, 0.414284649, 0.409068067, 0.403857479, 0.393493398,
  0.383256199, 0.373204819, 0.363377023, 0.353790763, 0.344457647, 0.335389692, 0.326754342,
  0.318279436, 0.310079210, 0.302189901,
};
static const double patch_r_min_error[] = {
  5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09,
  5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09, 5e-09,
  5e-09, 6e-06, 1e-04, 1e-04, 1e-04, 1e-04, 1e-04, 1e-04, 4e-04, 4e-04, 1e-03, 1e-03,
};

#define PATCH_SOURCE "boundary-integral computation of this project (COMPUTED)"

const struct reference_series *reference_square_patch_p_centre(void)
{
  static const struct reference_series series = {
    "t omega",      "p_centre / (rho omega^2 L^2)", PATCH_SOURCE, COUNT(patch_time), patch_time,
    patch_p_centre, patch_p_centre_error,           true};
  return &series;
}

const struct reference_series *reference_square_patch_r_min(void)
{
  static const struct reference_series series = {"t omega",         "r_min / L", PATCH_SOURCE,
                                                 COUNT(patch_time), patch_time,  patch_r_min,
                                                 patch_r_min_error, true};
  return &series;
}

/* Martin & Moyce 1952, n^2 = 2, a = 2.25 in. Table 2: surge front. */
static const double front_time[] = {
  0.41, 0.84, 1.19, 1.43, 1.63, 1.83, 1.98, 2.20, 2.32, 2.51, 2.65, 2.83, 2.98, 3.11, 3.33,
};
static const double front[] = {
  1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56, 2.78, 3.00, 3.22, 3.44, 3.67, 3.89, 4.11,
};

/* Table 6: residual height at the wall. */
static const double height_time[] = {
  0.56, 0.77, 0.93, 1.08, 1.28, 1.46, 1.66, 1.84, 2.00,
  2.21, 2.45, 2.70, 3.06, 3.44, 4.20, 5.25, 7.40,
};
static const double height[] = {
  0.94, 0.89, 0.83, 0.78, 0.72, 0.67, 0.61, 0.56, 0.50,
  0.44, 0.39, 0.33, 0.28, 0.22, 0.17, 0.11, 0.06,
};

/* Half of the last digit printed; the scatter between repeated runs is larger. */
static const double half_digit[] = {
  0.005, 0.005, 0.005, 0.005, 0.005, 0.005, 0.005, 0.005, 0.005,
  0.005, 0.005, 0.005, 0.005, 0.005, 0.005, 0.005, 0.005,
};

#define MARTIN_MOYCE "Martin & Moyce 1952, Phil. Trans. R. Soc. Lond. A 244, 312-324, "

_Static_assert(COUNT(half_digit) >= COUNT(front) && COUNT(half_digit) == COUNT(height),
               "one per row");

const struct reference_series *reference_martin_moyce_front(void)
{
  static const struct reference_series series = {
    "t sqrt(2 g/a)", "z/a", MARTIN_MOYCE "Table 2", COUNT(front_time), front_time, front,
    half_digit,      false};
  return &series;
}

const struct reference_series *reference_martin_moyce_height(void)
{
  static const struct reference_series series = {
    "t sqrt(g/a)", "height/(2a)", MARTIN_MOYCE "Table 6", COUNT(height_time), height_time, height,
    half_digit,    false};
  return &series;
}
