"""Faults to be planted in the sources, one at a time: what `mutate.py` does with them stands there.

Fault(name, what, file, old, new, run, metrics): `old` stands once in the file and becomes `new`; it
counts as caught where one of the `metrics` fails in a run whose name in the baseline holds `run`.
`variants` are those that are built again; `blind` says why a fault is not caught, where that is
known."""
import dataclasses


@dataclasses.dataclass
class Fault:
    name: str
    what: str
    file: str
    old: str
    new: str
    run: str
    metrics: tuple
    variants: tuple = ("2d-f64",)
    blind: str = ""


FAULTS = [
    Fault("dropped-warm-start", "DFSPH's density solver forgets the last step's pressures",
          "solvers/dfsph.c", "  if (s->warm_density > 0) sweep(correct_density, s);\n",
          "", "with dfsph ", ("iterations_mean",)),
    Fault("weaker-warm-start", "IISPH starts from nothing", "solvers/iisph.c",
          "s->push[i] *= s->warm;", "s->push[i] = 0;", "with iisph ",
          ("iterations_mean", "kinetic_energy", "volume_change")),
    Fault("kernel-constant", "the cubic kernel's norm in 2-D is 1 % too large",
          "core/sph/kernels.h", "80 / (7 * pi)", "80.8 / (7 * pi)", "dam-break",
          ("kinetic_energy",)),
    Fault("kernel-constant-wendland", "Wendland C4's gradient is 1 % too steep",
          "core/neighbours/pairs.h", "g = (real)56 / 3 * (1 - u)",
          "g = (real)56.56 / 3 * (1 - u)", "kernel=wendland4", ("kinetic_energy",)),
    Fault("sign", "WCSPH's artificial viscosity drives instead of damping", "solvers/wcsph.c",
          "-2 * s->alpha * s->c * mu", "2 * s->alpha * s->c * mu", "with wcsph ",
          ("kinetic_energy",)),
    Fault("missing-wall-term", "dual-particle solvers: walls do not hold particles off",
          "solvers/dual.h", "    sweep(add_hold, s);\n", "", "dual-", ("kinetic_energy",)),
    Fault("missing-wall-push", "IISPH: walls mirror no pressure", "solvers/iisph.c",
          "if (s->wall) force = madd(force, own, s->wall[i]);", "", "wall_pressure=mirrored",
          ("kinetic_energy",)),
    Fault("stale-neighbours", "neighbours are found in every other step only",
          "core/run/sets.c", "= list_neighbours(run);\n  clock_enter",
          "= run->step % 2 ? OK : list_neighbours(run);\n  clock_enter", "dam-break",
          ("kinetic_energy", "status")),
    Fault("neighbours-cut", "neighbours beyond 0.95 R are not found", "core/neighbours/search.c",
          "const real limit = sq(job->grid->support);\n  const vec period",
          "const real limit = (real)0.9 * sq(job->grid->support);\n  const vec period", "dam-break",
          ("density_error_mean",)),
    Fault("loose-tolerance", "CG stops at ten times its tolerance", "core/linear/cg.c",
          "    done = reached(s, rr, tolerance * tolerance * bb, excess);",
          "    done = reached(s, rr, 100 * tolerance * tolerance * bb, excess);", "dual-sa",
          ("iterations_mean",)),
    Fault("loose-iterations", "PCISPH: an allowed error ten times as large", "solvers/pcisph.c",
          "error <= (double)s->tolerance", "error <= 10 * (double)s->tolerance", "with pcisph ",
          ("iterations_mean", "iterations_max")),
    Fault("float-for-double", "positions go through single precision", "core/run/physics.c",
          "s->p.x[i] = madd(s->p.x[i], s->dt, s->p.v[i]); }",
          "const vec x = madd(s->p.x[i], s->dt, s->p.v[i]);\n"
          "  for (int d = 0; d < DIM; d++) s->p.x[i].c[d] = (real)(float)x.c[d]; }",
          "free-fall", ("trajectory_error",)),
    Fault("float-in-cg", "CG's residual goes through single precision", "core/linear/cg.c",
          "s->r[i] -= s->step * s->q[i];", "s->r[i] = (real)(float)(s->r[i] - s->step * s->q[i]);",
          "tank with ", ("residual_last", "residual.rate", "residual.curve")),
    Fault("gravity-twice", "gravity acts twice", "core/run/physics.c",
          "void physics_gravity(struct view *s) { sweep(fall, s); }",
          "void physics_gravity(struct view *s) { sweep(fall, s); sweep(fall, s); }", "free-fall",
          ("trajectory_error",)),
    Fault("mass-off", "particles are 1 % too light", "core/run/run.c", "return rho0 / total;",
          "return 0.99 * rho0 / total;", "tank", ("density_error_max",)),
    Fault("no-xsph", "XSPH is computed but not added", "core/run/physics.c",
          "  sweep(xsph, s);\n  sweep(add_change, s);\n", "  sweep(xsph, s);\n", "xsph=0.02",
          ("kinetic_energy",)),
    Fault("lost-clamp", "PBF pulls where it should only push", "solvers/pbf.c",
          "s->lambda[i] = s->clamp == (real)CLAMPED ? smaller(lambda, 0) : lambda;",
          "s->lambda[i] = lambda;", "with pbf ", ("kinetic_energy", "iterations_mean")),
    Fault("stencil-off-by-one", "S.C's nodes two steps away lie one step away on one side",
          "solvers/dual.c", "axis % 2 ? 2 : -2", "axis % 2 ? 1 : -2", "dual-sc",
          ("kinetic_energy",)),
    Fault("unsymmetric-matrix", "CG's product lacks the weights that make the matrix symmetric",
          "core/linear/cg.c", "return s->weight[i] * s->d[i] * s->q[i];",
          "return s->weight[0] * s->d[i] * s->q[i];", "dual-", ("iterations_mean",)),
    Fault("virtual-volume", "virtual particles' volumes are not saturated", "solvers/dual.h",
          "s->unit_volume * smaller(1, cI / SATURATION)", "s->unit_volume * cI / SATURATION",
          "dual-sc", ("kinetic_energy",)),
    Fault("akinci-walls", "walls of one layer weigh 5 % too little", "core/run/walls.c",
          "return (real)rho0 / sum(number);", "return (real)0.95 * (real)rho0 / sum(number);",
          "walls=akinci", ("kinetic_energy",)),
    Fault("viscosity-factor", "the viscous force has d + 1 for d + 2", "core/run/viscosity.c",
          "(central ? DIM + 2 : 1)", "(central ? DIM + 1 : 1)", "poiseuille",
          ("velocity_error",)),
    Fault("weak-tension", "the curve of cohesion is off by its constant", "core/run/tension.c",
          "a - (real)1 / 64", "a - (real)1 / 60", "tension=1", ("kinetic_energy",)),
    Fault("jitter-range", "disturbed starts are disturbed by half of what is said",
          "core/scene/scene.c", "reach * (2 * uniform - 1)", "reach * (uniform - (real)0.5)",
          "--seed *", ("kinetic_energy", "kinetic_energy.spread", "potential_energy")),
    Fault("no-divergence-solver", "DFSPH leaves out its divergence solver", "solvers/dfsph.c",
          "if (s->divergence_solver == (real)ON)", "if (0)", "with dfsph ", ("iterations_mean",)),
    Fault("third-dimension", "the cubic kernel's norm in 3-D is 1 % too large",
          "core/sph/kernels.h", "16 / pi}", "16.16 / pi}", "(openmp-3d-f64)",
          ("kinetic_energy",), ("3d-f64",)),
    Fault("short-move", "particles move 0.01 % less than their velocity says",
          "core/run/physics.c", "madd(s->p.x[i], s->dt, s->p.v[i]); }",
          "madd(s->p.x[i], (real)0.9999 * s->dt, s->p.v[i]); }", "free-fall",
          ("trajectory_error",)),
    Fault("short-move-float", "the same, in single precision only",
          "core/run/physics.c", "madd(s->p.x[i], s->dt, s->p.v[i]); }",
          "madd(s->p.x[i], (real)0.9999 * s->dt, s->p.v[i]); }", "(openmp-2d-f32)",
          ("total_energy", "density_error_mean"), ("2d-f32",)),
]
