#pragma once
/// Every integrator. Adding one is a header and a line in one of the lists; list, run, report, benchmarks and
/// conformance tests follow.
#include "integrators/catalog/body.hpp"
#include "integrators/catalog/explicit.hpp"
#include "integrators/catalog/gauss.hpp"
#include "integrators/catalog/group.hpp"
#include "integrators/catalog/rivals.hpp"
