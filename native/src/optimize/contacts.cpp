// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/contacts.hpp"

namespace dapple {
namespace {

constexpr int kSweeps = 20;

}  // namespace

bool add_contact(const Planes& planes, std::size_t i, std::size_t j, const Vec3& d, double least,
                 double nearly, std::vector<Contact>& contacts, double least_room) {
  const double distance = d.norm();
  const Vec3 at_i = planes.part(i, d / distance), at_j = planes.part(j, d / distance);
  const double room = at_i.squaredNorm() + at_j.squaredNorm();
  const bool enough = room > 0.0 && room >= least_room;
  if (enough) contacts.push_back({i, j, distance - least, at_i, at_j, room, nearly});
  return enough;
}

void separate(std::span<const Contact> contacts, Vectors& moves) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool any = false;
    for (const Contact& contact : contacts) {
      const double excess = contact.excess(moves);
      if (excess <= contact.nearly) continue;
      moves[contact.i] += excess / contact.room * contact.at_i;
      moves[contact.j] -= excess / contact.room * contact.at_j;
      any = true;
    }
    if (!any) return;
  }
}

}  // namespace dapple
