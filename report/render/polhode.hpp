#pragma once
/// The polhode: where the tip of the body rate runs on the inertia ellipsoid while no torque acts. It is where two
/// quadrics meet, so it is drawn without integrating anything.   Source: Landau & Lifshitz, Mechanics, sec. 37; Poinsot
/// 2T = J1 w1^2 + J2 w2^2 + J3 w3^2,   L^2 = J1^2 w1^2 + J2^2 w2^2 + J3^2 w3^2
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace polhode::report {

using Triple = std::array<double, 3>;

/// Principal moments of inertia and where their axes stand in the body: rows are unit vectors, right-handed, each near
/// the body axis of its place if the inertia is nearly diagonal.
struct PrincipalAxes {
  Triple moments{};              ///< [kg m^2]
  std::array<Triple, 3> axes{};  ///< a body vector w has the principal components axes[i] . w

  Triple components(Triple const& w) const;
};
/// Of an inertia matrix with the entries xx yy zz xy xz yz [kg m^2], by cyclic Jacobi rotations.
/// Source: Golub & Van Loan, Matrix Computations, sec. 8.5
PrincipalAxes principal_axes(std::array<double, 6> const& inertia);

/// A rigid body in principal axes and the rate that it starts with.
struct FreeSpin {
  Triple inertia{};  ///< principal moments [kg m^2], positive
  Triple omega0{};   ///< [rad/s], along the principal axes

  double energy_twice() const;      ///< 2T [J]
  double momentum_squared() const;  ///< L^2 [N^2 m^2 s^2]
  Triple semi_axes() const;         ///< of the inertia ellipsoid of that energy, in rates [rad/s]
  auto operator<=>(FreeSpin const&) const = default;
};

/// A closed curve of body rates [rad/s], its first point repeated at the end.
using RateCurve = std::vector<Triple>;

/// The two polhodes (they mirror each other) of a body with these moments, 2T and L^2, with `points` points each; the
/// first runs through rates with a positive component along the axis that it encircles. None if the two quadrics do
/// not meet, or if all moments are equal, where every rate stays as it is.
std::vector<RateCurve> polhodes(Triple const& inertia, double energy_twice, double momentum_squared,
                                std::size_t points = 96);

/// Polhodes of one energy that show the ellipsoid's face: around both stable axes, and the separatrix between them.
std::vector<RateCurve> polhode_family(FreeSpin const& spin, std::size_t points = 96);
/// The one of `polhodes` that the motion itself follows; empty if it stays where it is.
RateCurve own_polhode(FreeSpin const& spin, std::size_t points = 96);

/// The picture for who sees the page without scripts: parallel projection, the far side faint; an svg element.
std::string polhode_svg(FreeSpin const& spin, std::string_view title);

}  // namespace polhode::report
