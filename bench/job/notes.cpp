#include "bench/job/notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <thread>

#include "bench/input/vocabulary.hpp"

namespace polhode::bench {
namespace {

std::string packed(Note const& note) {
  std::string bytes(1 + sizeof note.k, char(note.word));
  std::memcpy(bytes.data() + 1, &note.k, sizeof note.k);
  return bytes + note.text;
}

Note unpacked(std::string const& bytes) {
  Note note;
  if (bytes.size() < 1 + sizeof note.k) throw std::logic_error("a message between ranks is too short");
  note.word = Word(bytes[0]);
  std::memcpy(&note.k, bytes.data() + 1, sizeof note.k);
  note.text = bytes.substr(1 + sizeof note.k);
  return note;
}

// What decides the exit code.
enum Kind : std::int64_t { usage, nothing_selected, out_of_memory, other };

}  // namespace

void send(Channel& channel, int to, Note const& note) {
  channel.send(to, packed(note));
}

void send_all(Channel& channel, Note const& note) {
  for (int to = 1; to < channel.size(); ++to) send(channel, to, note);
}

std::optional<Heard> hear(Channel& channel) {
  auto const message = channel.receive();
  if (!message) return {};
  return Heard{message->from, unpacked(message->bytes)};
}

Heard await(Channel& channel) {
  for (Patience patience;;) {
    auto heard = hear(channel);
    if (heard && heard->note.word != Word::stop) return *std::move(heard);
    if (!heard) std::this_thread::sleep_for(patience.next());
  }
}

Note note_of(std::exception_ptr const& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (UsageError const& error) {
    return {Word::failed, usage, error.what()};
  } catch (NothingSelected const& error) {
    return {Word::failed, nothing_selected, error.what()};
  } catch (std::bad_alloc const&) {
    return {Word::failed, out_of_memory, ""};
  } catch (std::exception const& error) {
    return {Word::failed, other, error.what()};
  } catch (...) {
    return {Word::failed, other, "an unknown failure"};
  }
}

std::exception_ptr failure_of(Heard const& failed) {
  std::string const text = fmt::format("{} (rank {})", failed.note.text, failed.from);
  switch (failed.note.k) {
    case usage:
      return std::make_exception_ptr(UsageError(text));
    case nothing_selected:
      return std::make_exception_ptr(NothingSelected(text));
    case out_of_memory:
      return std::make_exception_ptr(std::bad_alloc());
    default:
      return std::make_exception_ptr(std::runtime_error(text));
  }
}

}  // namespace polhode::bench
