// Everything of the library in one include.
#pragma once

#include <pointskin/attribute.hpp>
#include <pointskin/boolean.hpp>
#include <pointskin/camera.hpp>
#include <pointskin/cloud.hpp>
#include <pointskin/components.hpp>
#include <pointskin/deform.hpp>
#include <pointskin/device.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/edit.hpp>
#include <pointskin/error.hpp>
#include <pointskin/field.hpp>
#include <pointskin/fluid.hpp>
#include <pointskin/formats.hpp>
#include <pointskin/io.hpp>
#include <pointskin/merge.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/normals.hpp>
#include <pointskin/octree.hpp>
#include <pointskin/problems.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/render.hpp>
#include <pointskin/simulation.hpp>
#include <pointskin/vector.hpp>
#include <pointskin/vertex_normals.hpp>
#include <pointskin/workspace.hpp>
