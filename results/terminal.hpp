#pragma once
/// Text for a terminal, and for a pipe: tables that are aligned, fit into the window and say by colour what is good.
/// Colours go to terminals alone; what goes into a pipe or a file is plain and is not shortened.
#include <string>
#include <string_view>
#include <vector>

namespace polhode::results {

/// What is meant; the colour follows from it.
enum class Tone { plain, good, caution, bad, quiet, strong };

/// The tone of a word that stands for an outcome: a status, a verdict, a trend. Plain for every other text.
Tone tone_of(std::string_view word);

/// Where text goes.
struct Outlet {
  std::size_t width = 0;  ///< columns of the window; 0: nothing is shortened
  bool colour = false;
};

/// Colour on a terminal that knows it, unless NO_COLOR is set; CLICOLOR_FORCE (not 0) asks for it everywhere. A
/// terminal that does not tell its width has $COLUMNS, or 80.
Outlet outlet_of(int descriptor);

/// The text, in the tone's colour if the outlet has any.
std::string toned(std::string_view text, Tone tone, Outlet const& outlet);

struct TextColumn {
  std::string title;
  bool number = false;  ///< aligned to the right, never shortened
  bool keep = false;    ///< never shortened
};

struct TextCell {
  std::string text;
  Tone tone = Tone::plain;

  TextCell(std::string shown, Tone meant) : text(std::move(shown)), tone(meant) {}
  TextCell(std::string shown) : text(std::move(shown)), tone(tone_of(text)) {}
  TextCell(char const* shown) : TextCell(std::string(shown)) {}
};

/// One line for the titles and one for each row, columns two spaces apart. If it is too wide, the widest texts lose
/// their middle ("free_body//qu…ne/h=0.1"), down to 4 letters.
std::string text_table(std::vector<TextColumn> const& columns, std::vector<std::vector<TextCell>> const& rows,
                       Outlet const& outlet);

/// Words in lines of the outlet's width.
std::string wrapped(std::string_view text, Outlet const& outlet);

/// How many places a text in UTF-8 takes, one for each character.
std::size_t places(std::string_view text);

}  // namespace polhode::results
