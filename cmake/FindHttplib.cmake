# The target Httplib::Httplib, if cpp-httplib is found. pkg-config gives the
# options with which the distribution builds it. With these, newer versions of
# its header call OpenSSL, so programs have to link that as well.
find_package(PkgConfig QUIET)
if(PKG_CONFIG_FOUND)
  pkg_check_modules(HTTPLIB QUIET IMPORTED_TARGET cpp-httplib)
endif()
find_package(OpenSSL QUIET)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Httplib
  REQUIRED_VARS HTTPLIB_FOUND OPENSSL_FOUND)

if(Httplib_FOUND AND NOT TARGET Httplib::Httplib)
  target_link_libraries(PkgConfig::HTTPLIB INTERFACE OpenSSL::Crypto)
  add_library(Httplib::Httplib ALIAS PkgConfig::HTTPLIB)
endif()
