# An image with the programs of the project and nothing that builds them.
#
#   docker build --tag rgbd_pose .     (Debian 13: --build-arg DEBIAN=trixie)
#   docker run --rm --user "$(id -u):$(id -g)" --volume "$PWD:/data" rgbd_pose \
#     rgbd_odometry rgbd_dataset_freiburg1_xyz --camera=tum_fr1
#
# The volume is the folder with recordings; results go there, into runs. With
# --network=host browsers on this machine can open the page of --view.
# scripts/check_dockerfile runs these steps without Docker.
ARG DEBIAN=bookworm

FROM debian:${DEBIAN}-slim AS build
WORKDIR /rgbd_pose
# Packages are only installed again if their list has changed.
COPY scripts/install_dependencies scripts/
RUN scripts/install_dependencies build formats package
COPY . .
RUN cmake --preset release
RUN cmake --build --preset release
RUN cpack --config build/CPackConfig.cmake -G DEB -B /packages

FROM debian:${DEBIAN}-slim
COPY --from=build /packages/rgbd-pose-tools_*.deb /packages/
RUN apt-get update && \
  apt-get install --yes --no-install-recommends /packages/*.deb && \
  rm -r /packages /var/lib/apt/lists/*
WORKDIR /data
