#pragma once
/// What the adapters to SUNDIALS share: its objects with owners, and why a binary may lack it.
#include <string_view>

#ifdef POLHODE_HAS_SUNDIALS
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>

#include <memory>
#include <new>
#include <type_traits>
#endif

namespace polhode {

#ifdef POLHODE_HAS_SUNDIALS
inline constexpr std::string_view sundials_not_built = "";

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
#else
inline constexpr std::string_view sundials_not_built = "not built: configure with POLHODE_SUNDIALS=ON";
#endif

}  // namespace polhode
