// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/plausibility.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace palpate::probing {
namespace {

/// A sample as its contact sees it.
struct Press {
  const Sample* sample = nullptr;
  double normal = 0;      ///< [N] force along the outward normal; < 0: pressed
  double tangential = 0;  ///< [N] >= 0
  double height = 0;      ///< [mm] of `a` over the contact, along the normal; < 0: inside
};

using Presses = std::vector<Press>;

struct ProbedContact {
  const Contact* contact = nullptr;
  Presses presses;
  Eigen::Vector3d lightest = Eigen::Vector3d::Zero();  ///< [mm] `a` under the least normal force
};

double tangential_over_normal(const Press& press) {
  return press.tangential / std::abs(press.normal);
}

std::vector<ProbedContact> probed_contacts(const CheckedAcquisition& acquisition) {
  std::vector<ProbedContact> result;
  for (std::size_t i = 0; i < acquisition.contacts().size(); ++i) {
    const std::span<const Sample> samples = acquisition.samples_of(i);
    if (samples.empty()) continue;
    ProbedContact& probed = result.emplace_back();
    probed.contact = &acquisition.contacts()[i];
    const Eigen::Vector3d n = probed.contact->normal.normalized();
    for (const Sample& sample : samples) {
      const double along = n.dot(sample.force);
      probed.presses.push_back({&sample, along, (sample.force - along * n).norm(),
                                n.dot(sample.a - probed.contact->position)});
    }
    const auto least = std::ranges::min_element(
        probed.presses, {}, [](const Press& press) { return std::abs(press.normal); });
    probed.lightest = least->sample->a;
  }
  return result;
}

/// Four significant digits without trailing zeros: figures for reading.
std::string figure(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 4);
  return {text.data(), end.ptr};
}

std::string percent(double share) { return figure(std::round(100 * share)) + " %"; }

/// "contacts 3, 8 and 12 more", in words that are right for one id too.
std::string named(const std::string& noun, const std::vector<long long>& ids) {
  constexpr std::size_t kNamed = 10;
  std::string text = noun + (ids.size() == 1 ? " " : "s ");
  for (std::size_t i = 0; i < std::min(ids.size(), kNamed); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(ids[i]);
  return ids.size() > kNamed ? text + " and " + std::to_string(ids.size() - kNamed) + " more"
                             : text;
}

std::string count_of(std::size_t part, std::size_t all) {
  return std::to_string(part) + " of " + std::to_string(all);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// ------------------------------------------------------------------------------- signs

enum class Side { right, forces_reversed, normals_inwards, tool_outside };

/// Whether the tool goes outwards as it presses harder, and is there under the larger forces.
bool is_outside(const Presses& presses) {
  double weight = 0, height = 0, force = 0, squares = 0;
  for (const Press& press : presses) {
    weight += std::abs(press.normal);
    height += std::abs(press.normal) * press.height;
    squares += press.normal * press.normal;
  }
  if (!(weight > 0) || !(height > 0)) return false;
  const auto count = static_cast<double>(presses.size());
  force = weight / count;
  double mean = 0, forces = 0, heights = 0, product = 0;
  for (const Press& press : presses) mean += press.height / count;
  for (const Press& press : presses) {
    const double df = std::abs(press.normal) - force, dh = press.height - mean;
    forces += df * df;
    heights += dh * dh;
    product += df * dh;
  }
  // One level of force shows no change with it.
  constexpr double kOneLevel = 0.1;  // of the force, its standard deviation
  constexpr double kClearCorrelation = 0.5;
  if (forces <= kOneLevel * kOneLevel * squares) return height > kTouchError * weight;
  return product > kClearCorrelation * std::sqrt(forces * heights);
}

Side side_of(const Presses& presses) {
  double force = 0;
  for (const Press& press : presses) force += press.normal;
  const bool pulls = force > 0, outside = is_outside(presses);
  if (pulls) return outside ? Side::normals_inwards : Side::forces_reversed;
  return outside ? Side::tool_outside : Side::right;
}

Finding sign_finding(Implausibility kind, const std::vector<long long>& ids, std::size_t all,
                     bool impossible) {
  const std::string where = count_of(ids.size(), all) + " contacts (" + named("contact", ids) + ")";
  switch (kind) {
    case Implausibility::forces_reversed:
      return {kind, impossible,
              "at " + where +
                  " the forces px,py,pz point out of the object while the tool goes into it: they "
                  "are those of the object on the tool",
              "give the force of the tool on the object, so that px*nx + py*ny + pz*nz < 0: change "
              "the signs of px,py,pz"};
    case Implausibility::normals_inwards:
      return {kind, impossible,
              "at " + where +
                  " both the forces and the ways of the tool point along the normal: the normals "
                  "point into the object",
              "normals nx,ny,nz point out of the object, towards the tool: change their signs"};
    default:
      return {kind, impossible,
              "at " + where +
                  " the tool is outside of the object, on the side that the normal points to, "
                  "although the forces press inwards",
              "a is the position of the tool inside the undeformed surface, so that "
              "(ax - x)*nx + (ay - y)*ny + (az - z)*nz < 0: check the signs and the frame of the "
              "tool positions"};
  }
}

void find_signs(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  std::map<Side, std::vector<long long>> wrong;
  std::size_t count = 0;
  for (const ProbedContact& probed : contacts) {
    const Side side = side_of(probed.presses);
    if (side == Side::right) continue;
    wrong[side].push_back(probed.contact->id);
    ++count;
  }
  const bool impossible = 2 * count > contacts.size();
  const auto add = [&](Side side, Implausibility kind) {
    if (wrong.contains(side))
      findings.push_back(sign_finding(kind, wrong[side], contacts.size(), impossible));
  };
  add(Side::forces_reversed, Implausibility::forces_reversed);
  add(Side::normals_inwards, Implausibility::normals_inwards);
  add(Side::tool_outside, Implausibility::tool_outside);
}

/// Samples at contacts that are right as a whole.
void find_single_samples(const std::vector<ProbedContact>& contacts,
                         std::vector<Finding>& findings) {
  std::vector<long long> pulling, outside;
  for (const ProbedContact& probed : contacts) {
    if (side_of(probed.presses) != Side::right) continue;
    double force = 0, depth = 0;
    for (const Press& press : probed.presses) {
      force = std::max(force, std::abs(press.normal));
      depth = std::max(depth, std::abs(press.height));
    }
    for (const Press& press : probed.presses) {
      if (press.normal > kOppositeShare * force) pulling.push_back(press.sample->id);
      if (press.height > std::max(kOppositeShare * depth, kTouchError))
        outside.push_back(press.sample->id);
    }
  }
  if (!pulling.empty()) {
    findings.push_back({Implausibility::pulling_samples, false,
                        named("sample", pulling) + (pulling.size() == 1 ? " pulls" : " pull") +
                            " at the object, while the others of the same contact press",
                        "check the signs of px,py,pz there, or remove the samples"});
  }
  if (!outside.empty()) {
    findings.push_back({Implausibility::outside_samples, false,
                        named("sample", outside) + (outside.size() == 1 ? " has" : " have") +
                            " the tool position a far outside of the object",
                        "check ax,ay,az there, or remove the samples"});
  }
}

/// A tangential force does positive work from `a` to `b`.
void find_exchanged_ends(const std::vector<ProbedContact>& contacts,
                         std::vector<Finding>& findings) {
  constexpr double kClearly = 3;    // negative work over positive
  constexpr double kEnough = 0.02;  // of the work of pressing; less may be noise
  double forwards = 0, backwards = 0, pressing = 0;
  for (const ProbedContact& probed : contacts) {
    const Eigen::Vector3d n = probed.contact->normal.normalized();
    for (const Press& press : probed.presses) {
      if (press.sample->slipped) continue;
      const Sample& sample = *press.sample;
      const double work = (sample.force - press.normal * n).dot(sample.b - sample.a);
      (work > 0 ? forwards : backwards) += std::abs(work);
      pressing += std::abs(press.normal * press.height);
    }
  }
  if (backwards > kClearly * forwards && backwards > kEnough * pressing) {
    findings.push_back(
        {Implausibility::exchanged_ends, true,
         "tangential forces move the tool backwards, from a to b: " +
             percent(backwards / (forwards + backwards)) + " of their work is negative",
         "a is the position under the normal component alone, b under the whole force, and forces "
         "and positions are in one frame: check whether a and b are exchanged"});
  }
}

// ------------------------------------------------------------------------------- groups

/// Sums over groups of at least two samples.
struct GroupScatter {
  double force = 0;     ///< [N^2] of the normal forces about the mean of their group
  double position = 0;  ///< [mm^2] of `a`
  double freedom = 0;
  std::size_t largest = 0;  ///< samples of a group
  std::size_t groups = 0;
  double lowest = 0, highest = 0;  ///< [N] normal forces in the group where they differ most
};

GroupScatter group_scatter(const Presses& presses) {
  std::map<long long, std::vector<const Press*>> groups;
  for (const Press& press : presses) groups[press.sample->group].push_back(&press);
  GroupScatter result{.groups = groups.size()};
  for (const auto& [id, group] : groups) {
    const auto count = static_cast<double>(group.size());
    double force = 0;
    Eigen::Vector3d settled = Eigen::Vector3d::Zero();
    for (const Press* press : group) {
      force += press->normal / count;
      settled += press->sample->a / count;
    }
    double low = std::abs(force), high = low;
    for (const Press* press : group) {
      result.force += (press->normal - force) * (press->normal - force);
      result.position += (press->sample->a - settled).squaredNorm();
      low = std::min(low, std::abs(press->normal));
      high = std::max(high, std::abs(press->normal));
    }
    result.freedom += count - 1;
    result.largest = std::max(result.largest, group.size());
    if (high - low > result.highest - result.lowest) {
      result.lowest = low;
      result.highest = high;
    }
  }
  return result;
}

double mean_square_force(const Presses& presses) {
  double sum = 0;
  for (const Press& press : presses) sum += press.normal * press.normal;
  return sum / static_cast<double>(presses.size());
}

const char* const kGroupMeaning =
    "the samples of one contact with one group_id share their normal force: number the groups of a "
    "contact by their normal force, and give every sample a group_id of its own if each has "
    "another normal force";

void find_groups(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  GroupScatter all;
  double forces = 0, displacements = 0;
  std::size_t count = 0;
  std::vector<long long> mixed;
  for (const ProbedContact& probed : contacts) {
    const GroupScatter here = group_scatter(probed.presses);
    const double square = mean_square_force(probed.presses);
    all.force += here.force;
    all.position += here.position;
    all.freedom += here.freedom;
    if (here.highest - here.lowest > all.highest - all.lowest) {
      all.lowest = here.lowest;
      all.highest = here.highest;
    }
    if (here.force > kImpossibleGroupScatter * kImpossibleGroupScatter * square * here.freedom)
      mixed.push_back(probed.contact->id);
    forces += square * static_cast<double>(probed.presses.size());
    count += probed.presses.size();
    for (const Press& press : probed.presses)
      displacements += (press.sample->a - probed.contact->position).squaredNorm();
  }
  if (all.freedom == 0 || !(forces > 0)) return;
  const auto samples = static_cast<double>(count);
  const double scatter = std::sqrt(all.force / all.freedom / (forces / samples));
  const bool impossible = scatter > kImpossibleGroupScatter || 2 * mixed.size() > contacts.size();
  if (impossible || scatter > kSuspiciousGroupScatter || !mixed.empty()) {
    findings.push_back({Implausibility::mixed_groups, impossible,
                        "the normal forces within one group_id scatter by " + percent(scatter) +
                            " of the forces (root mean square), up to " + figure(all.lowest) +
                            " to " + figure(all.highest) + " N in one group" +
                            (mixed.empty() ? "" : ", most of all at " + named("contact", mixed)),
                        kGroupMeaning});
    return;
  }
  const double moved = std::sqrt(all.position / all.freedom);
  const double displaced = std::sqrt(displacements / samples);
  if (moved > std::max(kSuspiciousPositionScatter * displaced, kPositionScatter)) {
    findings.push_back(
        {Implausibility::scattered_groups, false,
         "the tool positions a within one group_id scatter by " + figure(moved) +
             " mm, at displacements of " + figure(displaced) + " mm (root mean square)",
         "a is the position under the normal component alone, which is the same for the whole "
         "group: check group_id, and whether a holds other positions"});
  }
}

// ------------------------------------------------------------------------------- units

/// [mm] Median distance from the middle of the points: a minority of them does not matter.
double spread(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  std::vector<double> values(points.size());
  for (Eigen::Index k = 0; k < 3; ++k) {
    std::ranges::transform(points, values.begin(), [k](const auto& point) { return point[k]; });
    middle[k] = median(values);
  }
  std::ranges::transform(points, values.begin(),
                         [&](const auto& point) { return (point - middle).norm(); });
  return median(values);
}

std::string unit_guess(double ratio) {
  constexpr double kThousand = 1000, kNear = 2;
  const auto is_near = [&](double value) { return ratio > value / kNear && ratio < value * kNear; };
  if (is_near(1 / kThousand)) return "as in m beside contacts in mm";
  if (is_near(kThousand)) return "as in mm beside contacts in m";
  if (ratio < 1) return "as displacements would, or positions in a larger unit";
  return "as positions in a smaller unit would";
}

void find_length_units(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  if (contacts.size() < 2) return;
  std::vector<Eigen::Vector3d> places, tools;
  for (const ProbedContact& probed : contacts) {
    places.push_back(probed.contact->position);
    tools.push_back(probed.lightest);
  }
  const double size = spread(places);
  if (!(size > 0)) return;
  const double ratio = spread(tools) / size;
  if (ratio < kLeastSpread || ratio > kLargestSpread) {
    findings.push_back(
        {Implausibility::length_units, true,
         "under the least forces, the tool positions a are spread over " + figure(ratio * size) +
             ", their contacts over " + figure(size) + " (medians from their middles), " +
             unit_guess(ratio),
         "x,y,z, ax,ay,az and bx,by,bz are positions in one frame and one unit, mm (for another "
         "unit of a whole file see probe import --length-unit)"});
    return;
  }
  std::vector<long long> far;
  std::vector<double> distances;
  for (const ProbedContact& probed : contacts) {
    distances.push_back((probed.lightest - probed.contact->position).norm());
    if (distances.back() > kSuspiciousDistance * size) far.push_back(probed.contact->id);
  }
  if (far.empty()) return;
  const double typical = median(distances);
  findings.push_back(
      {Implausibility::distant_tool, typical > kImpossibleDistance * size,
       "the tool is up to " + figure(*std::ranges::max_element(distances)) + " mm away from " +
           named("contact", far) + ", while the contacts are spread over " + figure(size) +
           " mm (median from their middle)",
       "contacts and tool positions are in one frame and one unit, mm: check these contacts, or "
       "the frames"});
}

void find_scales(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  Eigen::Vector3d low = contacts.front().contact->position, high = low;
  std::vector<double> displacements;
  double force = 0;
  for (const ProbedContact& probed : contacts) {
    low = low.cwiseMin(probed.contact->position);
    high = high.cwiseMax(probed.contact->position);
    for (const Press& press : probed.presses) {
      displacements.push_back((press.sample->a - probed.contact->position).norm());
      force = std::max(force, press.sample->force.norm());
    }
  }
  const double extent = (high - low).norm(), displacement = median(std::move(displacements));
  const char* const kMillimetres =
      "lengths are in mm: check the unit (probe import --length-unit), or ignore this if it is "
      "right";
  if (contacts.size() > 1 && (extent < kSmallestExtent || extent > kLargestExtent)) {
    findings.push_back({Implausibility::length_scale, false,
                        "all contacts lie within " + figure(extent) +
                            " mm, which is unlikely for an object under an arm",
                        kMillimetres});
  } else if (displacement < kSmallestDisplacement) {
    findings.push_back({Implausibility::length_scale, false,
                        "the tool moves the surface by " + figure(displacement) +
                            " mm (median), less than an arm can measure",
                        kMillimetres});
  }
  if (force < kSmallestForce || force > kLargestForce) {
    findings.push_back({Implausibility::force_scale, force == 0,
                        "the largest force is " + figure(force) +
                            " N, which is unlikely for an arm that probes a soft object",
                        "forces are in N: check the unit (probe import --force-unit), or ignore "
                        "this if it is right"});
  }
  std::vector<double> ratios;
  for (const ProbedContact& probed : contacts) {
    double largest = 0;
    for (const Press& press : probed.presses) {
      if (!press.sample->slipped && press.normal != 0)
        largest = std::max(largest, tangential_over_normal(press));
    }
    ratios.push_back(largest);
  }
  const double ratio = median(std::move(ratios));
  if (ratio > kLargestFriction) {
    findings.push_back({Implausibility::tilted_forces, false,
                        "samples that held have tangential forces of " + figure(ratio) +
                            " times the normal force (median of the largest at each contact)",
                        "px,py,pz have one unit and are in the frame of the normals nx,ny,nz, and "
                        "slipped is 1 where "
                        "the tool slid: check these columns"});
  }
}

// ------------------------------------------------------------------------------- slips

struct SlipOrder {
  double pairs = 0;   ///< of a slipped and a held sample
  double larger = 0;  ///< pairs in which the slipped one has the larger ratio; ties count half
};

SlipOrder slip_order(const Presses& presses) {
  std::vector<std::pair<double, bool>> ratios;
  for (const Press& press : presses) {
    if (press.normal != 0)
      ratios.emplace_back(tangential_over_normal(press), press.sample->slipped);
  }
  std::ranges::sort(ratios);
  SlipOrder order;
  double held = 0, slipped = 0;  // among smaller ratios
  for (std::size_t i = 0; i < ratios.size();) {
    double held_here = 0, slipped_here = 0;
    for (const double ratio = ratios[i].first; i < ratios.size() && ratios[i].first == ratio; ++i)
      (ratios[i].second ? slipped_here : held_here) += 1;
    order.larger += slipped_here * (held + held_here / 2);
    held += held_here;
    slipped += slipped_here;
  }
  order.pairs = held * slipped;
  return order;
}

void find_slips(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  const char* const kMeaning =
      "slipped is 1 where the tool slid and 0 where it held; check the column";
  SlipOrder all;
  std::vector<long long> reversed;
  bool any_held = false;
  for (const ProbedContact& probed : contacts) {
    const SlipOrder here = slip_order(probed.presses);
    all.pairs += here.pairs;
    all.larger += here.larger;
    if (here.pairs >= kFewestSlipPairs && here.larger < kReversedSlips * here.pairs)
      reversed.push_back(probed.contact->id);
    any_held = any_held || std::ranges::any_of(probed.presses, [](const Press& press) {
                 return !press.sample->slipped;
               });
  }
  if (!any_held) {
    findings.push_back({Implausibility::all_slipped, false,
                        "every sample is marked as slipped, so that no tool position b is used",
                        kMeaning});
    return;
  }
  if (all.pairs < kFewestSlipPairs) return;
  const double share = all.larger / all.pairs;
  if (share < kReversedSlips || !reversed.empty()) {
    findings.push_back(
        {Implausibility::slips_reversed, share < kReversedSlips,
         "samples that slipped have smaller tangential forces, relative to their normal force, "
         "than samples that held" +
             (reversed.empty() ? std::string() : " at " + named("contact", reversed)),
         kMeaning});
  } else if (share < kUnrelatedSlips) {
    findings.push_back(
        {Implausibility::slips_unrelated, false,
         "only " + percent(share) +
             " of the samples that slipped have a larger tangential force, relative to the normal "
             "force, than one that held at the same contact; without any relation it is 50 %",
         kMeaning});
  }
}

}  // namespace

const char* to_string(Implausibility kind) {
  switch (kind) {
    case Implausibility::forces_reversed:
      return "forces_reversed";
    case Implausibility::normals_inwards:
      return "normals_inwards";
    case Implausibility::tool_outside:
      return "tool_outside";
    case Implausibility::pulling_samples:
      return "pulling_samples";
    case Implausibility::outside_samples:
      return "outside_samples";
    case Implausibility::exchanged_ends:
      return "exchanged_ends";
    case Implausibility::mixed_groups:
      return "mixed_groups";
    case Implausibility::scattered_groups:
      return "scattered_groups";
    case Implausibility::length_units:
      return "length_units";
    case Implausibility::distant_tool:
      return "distant_tool";
    case Implausibility::length_scale:
      return "length_scale";
    case Implausibility::force_scale:
      return "force_scale";
    case Implausibility::tilted_forces:
      return "tilted_forces";
    case Implausibility::slips_reversed:
      return "slips_reversed";
    case Implausibility::slips_unrelated:
      return "slips_unrelated";
    case Implausibility::all_slipped:
      return "all_slipped";
  }
  return "";
}

std::string message(const Finding& finding) { return finding.what + "; " + finding.right; }

std::vector<Finding> find_implausible(const CheckedAcquisition& acquisition) {
  const std::vector<ProbedContact> contacts = probed_contacts(acquisition);
  std::vector<Finding> findings;
  if (contacts.empty()) return findings;
  find_length_units(contacts, findings);
  // Positions in another unit have no side.
  const auto impossible = [&] { return std::ranges::any_of(findings, &Finding::impossible); };
  if (!impossible()) {
    find_signs(contacts, findings);
    find_single_samples(contacts, findings);
  }
  if (!impossible()) find_exchanged_ends(contacts, findings);
  find_groups(contacts, findings);
  find_scales(contacts, findings);
  find_slips(contacts, findings);
  std::ranges::stable_sort(findings, {}, &Finding::kind);
  return findings;
}

}  // namespace palpate::probing
