#pragma once
/// What the adapters to SUNDIALS share: its objects with owners, dense linear algebra, callbacks, counters, and why a
/// binary may lack it.
#include <string_view>

#include "integrators/rivals/jacobian.hpp"

#ifdef POLHODE_HAS_SUNDIALS
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <memory>
#include <new>
#include <type_traits>
#endif

namespace polhode {

#ifdef POLHODE_HAS_SUNDIALS
inline constexpr std::string_view sundials_not_built = "";

/// Frees the library's objects.
struct SundialsFree {
  void operator()(SUNContext context) const { SUNContext_Free(&context); }
  void operator()(N_Vector v) const { N_VDestroy(v); }
  void operator()(SUNMatrix m) const { SUNMatDestroy(m); }
  void operator()(SUNLinearSolver s) const { SUNLinSolFree(s); }
  void operator()(SUNNonlinearSolver s) const { SUNNonlinSolFree(s); }
};
/// One of the library's objects; Pointer is its type.
template <class Pointer>
using SundialsOwned = std::unique_ptr<std::remove_pointer_t<Pointer>, SundialsFree>;

/// The memory of a solver, released by CVodeFree and the like.
template <void (*release)(void**)>
struct SundialsRelease {
  void operator()(void* memory) const { release(&memory); }
};
template <void (*release)(void**)>
using SundialsMemory = std::unique_ptr<void, SundialsRelease<release>>;

/// Throws std::bad_alloc.
inline SundialsOwned<SUNContext> make_sundials_context() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) throw std::bad_alloc();
  return SundialsOwned<SUNContext>(context);
}
/// Throws std::bad_alloc unless a library call that makes something has succeeded; 0 is success in all of SUNDIALS.
inline void require_made(int code) {
  if (code != 0) throw std::bad_alloc();
}

/// n zeros, the library's own storage. Throws std::bad_alloc.
inline SundialsOwned<N_Vector> make_vector(int n, SundialsOwned<SUNContext> const& context) {
  SundialsOwned<N_Vector> v(N_VNew_Serial(n, context.get()));
  if (!v) throw std::bad_alloc();
  N_VConst(0, v.get());
  return v;
}
inline double* numbers_of(SundialsOwned<N_Vector> const& v) {
  return N_VGetArrayPointer(v.get());
}

/// Dense matrix and solver for Newton's iteration.
struct SundialsDense {
  SundialsOwned<SUNMatrix> matrix;
  SundialsOwned<SUNLinearSolver> solver;

  /// For systems of the size of y. Throws std::bad_alloc.
  void make(SundialsOwned<N_Vector> const& y, SundialsOwned<SUNContext> const& context) {
    auto const n = N_VGetLength(y.get());
    matrix.reset(SUNDenseMatrix(n, n, context.get()));
    if (!matrix) throw std::bad_alloc();
    solver.reset(SUNLinSol_Dense(y.get(), matrix.get(), context.get()));
    if (!solver) throw std::bad_alloc();
  }
};

/// What CVODE and ARKODE hand back to our callbacks.
template <Problem P>
struct SundialsUser {
  LibraryField<P> field;
  Projections projections{};  ///< those that the library asked for
};
/// Their right-hand side: dydt = f(t, y).
template <Problem P>
int sundials_field(double t, N_Vector y, N_Vector dydt, void* user) {
  static_cast<SundialsUser<P> const*>(user)->field(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt));
  return 0;
}
/// Their Jacobian, dense: the problem's own. Null where it has none: they then take difference quotients.
using SundialsJacobian = int (*)(double t, N_Vector y, N_Vector dydt, SUNMatrix, void* user, N_Vector, N_Vector,
                                 N_Vector);
template <Problem P>
SundialsJacobian sundials_jacobian([[maybe_unused]] P const& problem) {
  if constexpr (DifferentiableProblem<P>)
    if (problem.has_jacobian())
      return [](double t, N_Vector y, N_Vector, SUNMatrix matrix, void* user, N_Vector, N_Vector, N_Vector) {
        auto const& field = static_cast<SundialsUser<P> const*>(user)->field;
        write_jacobian(field, t, N_VGetArrayPointer(y), SUNDenseMatrix_Data(matrix));
        return 0;
      };
  return nullptr;
}

/// The counters of a solver start anew at each re-initialisation; we keep the sum. Null: the solver has none.
struct SundialsCounters {
  long steps = 0, failures = 0;
  std::optional<long> iterations{}, jacobians{};

  void add_to(Work& sum) const {
    sum.steps += steps;
    sum.rejected += failures;
    if (iterations) sum.iterations = sum.iterations.value_or(0) + *iterations;
    if (jacobians) sum.jacobians = sum.jacobians.value_or(0) + *jacobians;
  }
};
#else
inline constexpr std::string_view sundials_not_built = "not built: configure with POLHODE_SUNDIALS=ON";
#endif

}  // namespace polhode
