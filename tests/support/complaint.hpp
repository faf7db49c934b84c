#pragma once
/// What is thrown, as words.
#include <string>

namespace polhode::test {

/// The message of the Error that f() throws; empty if it throws none.
template <class Error, class F>
std::string complaint_of(F&& f) {
  try {
    f();
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

}  // namespace polhode::test
