// The structs of the C interface, their kinds and defaults, which are those of C++.
#pragma once

#include <pointskin/c.h>

#include <cstring>

#include "c/guard.hpp"

namespace pointskin::c {

/// Fills a struct of zeros, without its size.
void set_defaults(psk_options& options);
void set_defaults(psk_normal_options& options);
void set_defaults(psk_read_options& options);
void set_defaults(psk_write_options& options);
void set_defaults(psk_compare_options& options);
void set_defaults(psk_render_options& options);
void set_defaults(psk_problem_options& options);
void set_defaults(psk_edit_options& options);
void set_defaults(psk_operation& operation);
void set_defaults(psk_handle& handle);
void set_defaults(psk_lattice& lattice);
void set_defaults(psk_boolean_options& options);
void set_defaults(psk_fluid_options& options);
void set_defaults(psk_scale_options& options);

/// Reports and arrays begin as zeros.
template <class T>
void set_defaults(T& /*report*/) {}

/// Calls f(T{}) with the struct of a kind. @returns false for an unknown kind
template <class F>
bool visit_struct(int kind, const F& f) {
  switch (kind) {
    case PSK_STRUCT_OPTIONS:
      f(psk_options{});
      return true;
    case PSK_STRUCT_NORMAL_OPTIONS:
      f(psk_normal_options{});
      return true;
    case PSK_STRUCT_READ_OPTIONS:
      f(psk_read_options{});
      return true;
    case PSK_STRUCT_WRITE_OPTIONS:
      f(psk_write_options{});
      return true;
    case PSK_STRUCT_POINTS:
      f(psk_points{});
      return true;
    case PSK_STRUCT_TRIANGLES:
      f(psk_triangles{});
      return true;
    case PSK_STRUCT_RUN_REPORT:
      f(psk_run_report{});
      return true;
    case PSK_STRUCT_NORMAL_REPORT:
      f(psk_normal_report{});
      return true;
    case PSK_STRUCT_MESH_REPORT:
      f(psk_mesh_report{});
      return true;
    case PSK_STRUCT_COMPARE_OPTIONS:
      f(psk_compare_options{});
      return true;
    case PSK_STRUCT_COMPARISON:
      f(psk_comparison{});
      return true;
    case PSK_STRUCT_RENDER_OPTIONS:
      f(psk_render_options{});
      return true;
    case PSK_STRUCT_RENDER_REPORT:
      f(psk_render_report{});
      return true;
    case PSK_STRUCT_PROBLEM_OPTIONS:
      f(psk_problem_options{});
      return true;
    case PSK_STRUCT_PROBLEM:
      f(psk_problem{});
      return true;
    case PSK_STRUCT_EDIT_OPTIONS:
      f(psk_edit_options{});
      return true;
    case PSK_STRUCT_OPERATION:
      f(psk_operation{});
      return true;
    case PSK_STRUCT_STEP_REPORT:
      f(psk_step_report{});
      return true;
    case PSK_STRUCT_HANDLE:
      f(psk_handle{});
      return true;
    case PSK_STRUCT_LATTICE:
      f(psk_lattice{});
      return true;
    case PSK_STRUCT_DEFORM_REPORT:
      f(psk_deform_report{});
      return true;
    case PSK_STRUCT_BOOLEAN_OPTIONS:
      f(psk_boolean_options{});
      return true;
    case PSK_STRUCT_BOOLEAN_REPORT:
      f(psk_boolean_report{});
      return true;
    case PSK_STRUCT_FLUID_OPTIONS:
      f(psk_fluid_options{});
      return true;
    case PSK_STRUCT_FLUID_REPORT:
      f(psk_fluid_report{});
      return true;
    case PSK_STRUCT_DEPTH_SUGGESTION:
      f(psk_depth_suggestion{});
      return true;
    case PSK_STRUCT_SCALE_OPTIONS:
      f(psk_scale_options{});
      return true;
    default:
      return false;
  }
}

template <class T>
T defaults() {
  T value;
  std::memset(&value, 0, sizeof(value));  // the padding, too: later versions may have members there
  set_defaults(value);
  value.size = sizeof(value);
  return value;
}

}  // namespace pointskin::c
