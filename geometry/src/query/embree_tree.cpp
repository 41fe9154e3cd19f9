// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/bounding_tree.h"

#include <embree3/rtcore.h>

#include <memory>
#include <string>
#include <type_traits>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "query/quick_tree.h"

namespace palpate::geometry {
namespace {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseBvh {
  void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using Bvh = std::unique_ptr<std::remove_pointer_t<RTCBVH>, ReleaseBvh>;

/// A node built by Embree, in Embree's memory: an inner node, or a leaf with `triangle` set.
struct BuiltNode {
  std::array<const BuiltNode*, TreeNode::kSize> child;
  std::array<int, TrianglePacket::kSize> triangle;
  bool is_leaf;
};

void* create_node(RTCThreadLocalAllocator allocator, unsigned /*children*/, void* /*user*/) {
  void* memory = rtcThreadLocalAlloc(allocator, sizeof(BuiltNode), alignof(BuiltNode));
  return new (memory) BuiltNode{.child = {}, .triangle = {-1, -1, -1, -1}, .is_leaf = false};
}

void set_children(void* node, void** children, unsigned count, void* /*user*/) {
  for (unsigned i = 0; i < count; ++i) {
    static_cast<BuiltNode*>(node)->child[i] = static_cast<const BuiltNode*>(children[i]);
  }
}

/// `refit` sets the boxes later, as after every move.
void ignore_bounds(void* /*node*/, const RTCBounds** /*bounds*/, unsigned /*count*/,
                   void* /*user*/) {}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives,
                  std::size_t count, void* /*user*/) {
  void* memory = rtcThreadLocalAlloc(allocator, sizeof(BuiltNode), alignof(BuiltNode));
  auto* leaf = new (memory) BuiltNode{.child = {}, .triangle = {-1, -1, -1, -1}, .is_leaf = true};
  for (std::size_t i = 0; i < count; ++i)
    leaf->triangle[i] = static_cast<int>(primitives[i].primID);
  return leaf;
}

std::vector<RTCBuildPrimitive> triangle_boxes(const Eigen::Matrix3Xd& vertices,
                                              const Eigen::Matrix3Xi& triangles) {
  std::vector<RTCBuildPrimitive> boxes(static_cast<std::size_t>(triangles.cols()));
  parallel_for(boxes.size(), [&](std::size_t i) {
    const auto t = static_cast<Eigen::Index>(i);
    const Eigen::Vector3f a = vertices.col(triangles(0, t)).cast<float>();
    const Eigen::Vector3f b = vertices.col(triangles(1, t)).cast<float>();
    const Eigen::Vector3f c = vertices.col(triangles(2, t)).cast<float>();
    const Eigen::Vector3f lower = a.cwiseMin(b).cwiseMin(c), upper = a.cwiseMax(b).cwiseMax(c);
    boxes[i] = {lower[0], lower[1], lower[2], 0,
                upper[0], upper[1], upper[2], static_cast<unsigned>(i)};
  });
  return boxes;
}

/// Copies the tree built by Embree: the packet of a leaf, or a node and everything below it.
/// Returns the value for `TreeNode::child`.
int copy(BoundingTree& tree, const BuiltNode& built, int depth) {
  if (depth > BoundingTree::kMaxDepth)
    throw SolverError("SurfaceQuery: the search tree is too deep");
  if (built.is_leaf) {
    tree.packets.emplace_back().triangle = built.triangle;
    return ~static_cast<int>(tree.packets.size() - 1);
  }
  const std::size_t node = tree.nodes.size();
  tree.nodes.emplace_back();
  for (std::size_t i = 0; i < built.child.size() && built.child[i] != nullptr; ++i) {
    const int child = copy(tree, *built.child[i], depth + 1);
    tree.nodes[node].child[i] = child;
    tree.nodes[node].children |= 1U << i;
  }
  return static_cast<int>(node);
}

}  // namespace

BoundingTree build_tree(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                        double margin, TreeBuild build) {
  if (build == TreeBuild::quick) return build_quick_tree(vertices, triangles, margin);
  const Device device(rtcNewDevice(nullptr));
  if (!device) throw SolverError("SurfaceQuery: Embree gave no device to build a search tree with");
  const Bvh bvh(rtcNewBVH(device.get()));
  std::vector<RTCBuildPrimitive> boxes = triangle_boxes(vertices, triangles);
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.maxBranchingFactor = TreeNode::kSize;
  arguments.sahBlockSize = TrianglePacket::kSize;
  arguments.minLeafSize = TrianglePacket::kSize;
  arguments.maxLeafSize = TrianglePacket::kSize;
  arguments.bvh = bvh.get();
  arguments.primitives = boxes.data();
  arguments.primitiveCount = boxes.size();
  arguments.primitiveArrayCapacity = boxes.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = ignore_bounds;
  arguments.createLeaf = create_leaf;
  const auto* root = static_cast<const BuiltNode*>(rtcBuildBVH(&arguments));
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE || root == nullptr) {
    throw SolverError("SurfaceQuery: the search tree of " + std::to_string(boxes.size()) +
                      " triangles could not be built; is there enough memory?");
  }
  BoundingTree tree;
  if (root->is_leaf) {
    const BuiltNode above{.child = {root}, .triangle = {}, .is_leaf = false};
    copy(tree, above, 0);
  } else {
    copy(tree, *root, 0);
  }
  refit(tree, vertices, triangles, margin);
  return tree;
}

}  // namespace palpate::geometry
