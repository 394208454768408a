/* plugin.h - a solver outside this tree: a shared object with one `const struct solver
 * sphbench_solver`, and with SPHBENCH_PLUGIN what it was compiled for. It is loaded by
 *   sphbench run SCENE --solver NAME --plugin PATH
 * where PATH is the object, or the folder or beginning of the name of objects for several variants,
 * NAME-2d-f64.so and so on. */
#ifndef PLUGIN_H
#define PLUGIN_H
#include "solver.h"

/* What must be the same in the plug-in and in the executable, or one would read the other's memory
 * wrongly. */
struct plugin_build {
  int abi, dim, real_bytes, lanes;
  size_t view_bytes, solver_bytes;
  const char *variant, *layout;
};

#define PLUGIN_TEXT_(...) #__VA_ARGS__
#define PLUGIN_TEXT(...) PLUGIN_TEXT_(__VA_ARGS__)
#define PLUGIN_ABILITY(name, text) #name " "
/* Every public field, every ability and the head of a state, in their order. */
static const char plugin_layout[] =
#define FIELD(type, name, where, life, unit, meaning) #type " " #name " " #where " " #life "; "
#include "particles/fields.def"
#undef FIELD
  ABILITY_LIST(PLUGIN_ABILITY) PLUGIN_TEXT(VIEW);

#define PLUGIN_BUILD                                                                       \
  {                                                                                        \
    SOLVER_ABI, DIM, (int)sizeof(real), LANES, sizeof(struct view), sizeof(struct solver), \
      SPHBENCH_VARIANT, plugin_layout                                                      \
  }

#ifdef __cplusplus
extern "C" {
#endif
extern const struct solver sphbench_solver;
extern const struct plugin_build sphbench_build;
#ifdef __cplusplus
}
#endif

/* Once in a plug-in, outside of functions. */
#define SPHBENCH_PLUGIN const struct plugin_build sphbench_build = PLUGIN_BUILD

#endif
