// stdin, stdout and stderr, which a caller may have closed.
#pragma once

namespace pointskin::cli {

/// Puts /dev/null where stdin, stdout or stderr are closed, so that no file which is opened later takes their place and
/// gets what is said on stderr. It cannot be read as stdin, nor written as stdout or stderr: using them is an error as
/// before. Call it before anything is opened.
void hold_standard_files();

/// False if stdout was closed when the program began.
bool stdout_is_open();

/// Copies stdin to memory if it is a pipe, so that its start can be looked at before it is read.
/// @throws Error invalid_input if it cannot be read, over_limit if memory runs out
void make_stdin_seekable();

}  // namespace pointskin::cli
