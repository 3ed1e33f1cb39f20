// A certificate for the faces round one vertex that answers, for all pairs of them at once, what improper_contact()
// would be asked for each: whether they meet outside the vertices and edges that they share.
#pragma once

#include <cstddef>

namespace prcage {

// The faces (centre, link[i], link[i + 1]), cyclic in i: is it certain, by floating-point arithmetic with an error
// bound, that no two of them are in improper contact? The link must be the whole cycle round the vertex, at least three
// vertices, in order. Coordinates must be within the limits of core/surface.h. False says nothing.
//
// The certificate is a direction along which the projection of the star on a plane is injective:
// - Every projected face is positively oriented. Seen from the centre, each face then takes up an angle between 0 and
//   pi, and walking along the link turns round the centre in one sense only, by 2 pi k in all.
// - k is 1: along the link, a linear function of the projected position goes from negative to positive once.
// The angles of the faces then fill the plane round the centre without overlap. Two faces that share the centre only
// have nothing but the centre in common, since their projections do not; two that share an edge lie on different sides
// of its projection, so that they are not folded onto each other.
bool star_certainly_embedded(const double* centre, const double* const* link, std::size_t size);

}  // namespace prcage
