// The exit codes of the program, in one place: the code, the help texts and the tests name them from here.
#pragma once

namespace prcage {

enum class ExitCode : int {
  ok = 0,
  internal_error = 1,           // a defect of the program, or out of memory
  usage = 2,                    // unknown or malformed option, nothing done
  cannot_read = 3,              // no such file, or not a mesh
  invalid_mesh = 4,             // the input has defects: no cage can be made of it
  face_budget_not_reached = 5,  // the cage is valid and written, but has more faces than asked for
  no_cage = 6,                  // no cage possible, or the certificate failed: nothing written
  cannot_write = 7,
  interrupted = 130,  // the valid cage reached so far is written
};

// For the help texts.
inline constexpr const char* exit_codes_help =
    "Exit codes:\n"
    "  0    done\n"
    "  1    internal error, or out of memory\n"
    "  2    unknown or malformed option\n"
    "  3    a file cannot be read, or is not a mesh\n"
    "  4    the input mesh is not valid\n"
    "  5    face budget not reached; the cage is valid and written\n"
    "  6    no cage possible, or a certificate failed; nothing written\n"
    "  7    a file cannot be written\n"
    "  130  interrupted; the valid cage reached so far is written";

}  // namespace prcage
