# fibertwin with OpenFOAM on Debian. Not built where it was written: no Docker was there.
FROM debian:bookworm-slim
RUN apt-get update \
 && apt-get install --yes --no-install-recommends python3 python3-venv openfoam openmpi-bin libgl1 libegl1 libgl1-mesa-dri libxrender1 \
 && rm -rf /var/lib/apt/lists/*
ENV WM_PROJECT_DIR=/usr/share/openfoam PATH=/opt/fibertwin/bin:$PATH
COPY . /src
RUN python3 -m venv /opt/fibertwin \
 && /opt/fibertwin/bin/pip install --no-cache-dir --constraint /src/constraints.txt /src \
 && rm -rf /src
# MPI refuses to run as root
RUN useradd --create-home engineer
USER engineer
WORKDIR /work
ENTRYPOINT ["fibertwin"]
CMD ["--help"]
