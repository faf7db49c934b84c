#pragma once
/// The colours of curves: the same places in gnuplot's pictures and in the page's.
#include <array>
#include <string_view>

namespace polhode::report {

/// One colour, "#RRGGBB": on light ground and on dark.
struct Colour {
  std::string_view light, dark;
};

/// Okabe and Ito's colours without the yellow, which is lost on white, and darker ones of Tol's; on dark ground lighter
/// ones. Sixteen colours alone cannot be told apart by the colour-blind: symbols help, and dashes.
inline constexpr std::array<Colour, 16> curve_colours{{{"#56B4E9", "#56B4E9"},
                                                       {"#E69F00", "#E69F00"},
                                                       {"#009E73", "#1FC797"},
                                                       {"#0072B2", "#4A9FE0"},
                                                       {"#000000", "#F2F2F2"},
                                                       {"#8C510A", "#C98A45"},
                                                       {"#CC79A7", "#E39BC3"},
                                                       {"#882255", "#D0628F"},
                                                       {"#999933", "#C2C24D"},
                                                       {"#332288", "#8F86E8"},
                                                       {"#CC3311", "#FF6B4D"},
                                                       {"#117733", "#4CB86A"},
                                                       {"#D55E00", "#FF8A3D"},
                                                       {"#44AA99", "#5FD0BE"},
                                                       {"#AA4499", "#D47AD4"},
                                                       {"#6B6BD6", "#9C9CF5"}}};

/// Points below the reference's bar, and the part of a picture where rounding rules.
inline constexpr Colour pale{"#9A9A9A", "#7A8188"}, shade{"#EFEFEC", "#262B30"};
/// A picture's ground, lines and letters. On the page they are the page's own.
inline constexpr std::string_view paper = "#fdfdfc", frame = "#555555", grid = "#DDDDDD", letters = "#333333";

}  // namespace polhode::report
