// What answers say besides what was asked for.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "studio/server/request.hpp"

namespace pointskin::studio::server {

using Field = std::pair<std::string_view, std::string_view>;

/// Headers of every answer, whatever it is: what browsers may do with it.
std::span<const Field> fields_of_every_answer();

/// One line for people.
std::string_view story_of(Status status);

/// The value of Content-Disposition: to be saved under this name, in whatever letters.
std::string attachment(std::string_view name);

}  // namespace pointskin::studio::server
