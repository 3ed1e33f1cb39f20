// The exit codes of the program, in one place: the code, the help texts and the tests name them from here.
#pragma once

#include <array>

namespace prcage {

enum class ExitCode : int {
  ok = 0,
  internal_error = 1,           // a defect of the program, or out of memory
  usage = 2,                    // unknown or malformed option, or one that this build lacks; nothing done
  cannot_read = 3,              // no such file, or not a mesh
  invalid_mesh = 4,             // the input has defects: no cage can be made of it
  face_budget_not_reached = 5,  // the cage is valid and written, but has more faces than asked for
  no_cage = 6,                  // no cage possible, or none in time, or the certificate failed: nothing written
  cannot_write = 7,
  some_failed = 8,       // batch: the table is complete, but some meshes have no cage
  deadline_reached = 9,  // the valid cage reached so far is written
  interrupted = 130,     // the valid cage reached so far is written
};

inline constexpr std::array all_exit_codes{
    ExitCode::ok,           ExitCode::internal_error,          ExitCode::usage,       ExitCode::cannot_read,
    ExitCode::invalid_mesh, ExitCode::face_budget_not_reached, ExitCode::no_cage,     ExitCode::cannot_write,
    ExitCode::some_failed,  ExitCode::deadline_reached,        ExitCode::interrupted,
};

// What the program says when memory runs out, and knows again when it has run itself as a child.
inline constexpr const char* out_of_memory_text = "not enough memory";

// For the help texts.
constexpr const char* meaning(ExitCode code) {
  switch (code) {
    case ExitCode::ok:
      return "done";
    case ExitCode::internal_error:
      return "internal error, or out of memory";
    case ExitCode::usage:
      return "unknown or malformed command, argument or option, or one that this build lacks";
    case ExitCode::cannot_read:
      return "a file cannot be read, or is not a mesh";
    case ExitCode::invalid_mesh:
      return "the input mesh is not valid";
    case ExitCode::face_budget_not_reached:
      return "face budget not reached; the cage is valid and written";
    case ExitCode::no_cage:
      return "no cage possible, none before the deadline, or a certificate failed; no cage written";
    case ExitCode::cannot_write:
      return "a file cannot be written";
    case ExitCode::some_failed:
      return "batch: some meshes have no cage; the table says why";
    case ExitCode::deadline_reached:
      return "deadline reached; the valid cage reached so far is written";
    case ExitCode::interrupted:
      return "interrupted; the valid cage reached so far is written";
  }
  return "";
}

}  // namespace prcage
