// Without the classes for the properties in files of OpenMesh's own format, which take minutes to compile.
#include <OpenMesh/Core/Utils/PropertyCreator.hh>
#undef OM_REGISTER_PROPERTY_TYPE
#define OM_REGISTER_PROPERTY_TYPE(type)
#include <OpenMesh/Core/Utils/PropertyCreator.cc>
