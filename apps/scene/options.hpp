// Options of a reconstruction as JSON: one table of keys, those of `options` in docs/edit.schema.json.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/reconstruct.hpp>

#include "scene/json_reader.hpp"

namespace pointskin::scene {

/// The keys: depth, field, screening and so on, in the order of reports. What says where data comes from or goes to
/// (inputs, device, envelope and the like) is not among them.
const std::vector<std::string>& option_keys();

/// All of them with their values.
nlohmann::ordered_json options_json(const Options& options);

/// `options` with what `json`, an object, names. A key `op` is passed over.
/// @throws Error invalid_input, naming the place, for an unknown key, a wrong type or a value out of range
Options read_options(const JsonReader& json, Options options);

/// Sets the option `key` of `to` to its value in `from`. @throws Error internal for an unknown key
void copy_option(const std::string& key, const Options& from, Options& to);

}  // namespace pointskin::scene
