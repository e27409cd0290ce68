C     Elastic, perfectly plastic soil with the yield surface of Mohr
C     and Coulomb, flow by the angle of dilation, and a cut-off of
C     tension at the apex, as a UMAT. It gives the stresses of the
C     model mohr_coulomb.
C
C     PROPS   1 Young's modulus [Pa], 2 Poisson's ratio, 3 cohesion
C             [Pa], 4 angle of friction [deg], 5 of dilation [deg]
C     STATEV  1 plastic engineering shear strain
C
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,
     1 RPL,DDSDDT,DRPLDE,DRPLDT,
     2 STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,CMNAME,
     3 NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     4 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
C
      INCLUDE 'ABA_PARAM.INC'
C
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),
     1 DDSDDE(NTENS,NTENS),DDSDDT(NTENS),DRPLDE(NTENS),
     2 STRAN(NTENS),DSTRAN(NTENS),TIME(2),PREDEF(1),DPRED(1),
     3 PROPS(NPROPS),COORDS(3),DROT(3,3),DFGRD0(3,3),DFGRD1(3,3),
     4 JSTEP(4)
C
      DIMENSION PS(3),AN(3,3),T(3),S(3),BY(3),IORDER(3)
C
      IF (NPROPS.NE.5 .OR. NSTATV.LT.1 .OR. NDI.NE.3) THEN
        CALL STDB_ABQERR(-3,'mohr_coulomb.f takes 5 properties, '//
     1   '1 state, and plane strain or 3D',0,0.D0,' ')
      END IF
      E=PROPS(1)
      V=PROPS(2)
      G=E/(2.D0*(1.D0+V))
      ALAME=E*V/((1.D0+V)*(1.D0-2.D0*V))
C
C     Stiffness. An explicit program takes the fastest wave from it,
C     so it is the elastic one.
C
      DO J=1,NTENS
        DO I=1,NTENS
          DDSDDE(I,J)=0.D0
        END DO
      END DO
      DO J=1,NDI
        DO I=1,NDI
          DDSDDE(I,J)=ALAME
        END DO
        DDSDDE(J,J)=ALAME+2.D0*G
      END DO
      DO J=NDI+1,NTENS
        DDSDDE(J,J)=G
      END DO
C
C     Elastic trial stress and its principal stresses T(1) largest.
C
      DO J=1,NTENS
        DO I=1,NTENS
          STRESS(I)=STRESS(I)+DDSDDE(I,J)*DSTRAN(J)
        END DO
      END DO
      CALL SPRIND(STRESS,PS,AN,1,NDI,NSHR)
      IORDER(1)=1
      IORDER(2)=2
      IORDER(3)=3
      CALL BIGGER(PS,IORDER(1),IORDER(2))
      CALL BIGGER(PS,IORDER(2),IORDER(3))
      CALL BIGGER(PS,IORDER(1),IORDER(2))
      DO K=1,3
        T(K)=PS(IORDER(K))
      END DO
      CALL RETURNMC(T,V,PROPS(3),PROPS(4),PROPS(5),S)
C
C     Stress by the changes along the principal axes, which for
C     NSHR=1 are those of the plane and the axis 3.
C
      BMEAN=0.D0
      DO K=1,3
        BY(K)=S(K)-T(K)
        BMEAN=BMEAN+BY(K)/3.D0
      END DO
      SQUARE=0.D0
      DO K=1,3
        I=IORDER(K)
        DO J=1,3
          STRESS(J)=STRESS(J)+BY(K)*AN(I,J)**2
        END DO
        STRESS(4)=STRESS(4)+BY(K)*AN(I,1)*AN(I,2)
        IF (NSHR.EQ.3) THEN
          STRESS(5)=STRESS(5)+BY(K)*AN(I,1)*AN(I,3)
          STRESS(6)=STRESS(6)+BY(K)*AN(I,2)*AN(I,3)
        END IF
        SQUARE=SQUARE+(BY(K)-BMEAN)**2
      END DO
      STATEV(1)=STATEV(1)+SQRT(SQUARE/2.D0)/G
      CALL SINV(STRESS,AMEAN,AMISES,NDI,NSHR)
      SSE=AMEAN**2/(2.D0*ALAME+4.D0*G/3.D0)+AMISES**2/(6.D0*G)
      RETURN
      END
C
C     Puts the places of two values in descending order.
C
      SUBROUTINE BIGGER(PS,I,J)
      INCLUDE 'ABA_PARAM.INC'
      DIMENSION PS(3)
      IF (PS(J).GT.PS(I)) THEN
        K=I
        I=J
        J=K
      END IF
      RETURN
      END
C
C     Return of principal stresses T to S, both in descending order:
C     the plane, its two edges, or the apex (Clausen, Damkilde &
C     Andersen 2006; de Souza Neto, Peric & Owen 2008, 8.2).
C
      SUBROUTINE RETURNMC(T,V,C,PHI,PSI,S)
      INCLUDE 'ABA_PARAM.INC'
      DIMENSION T(3),S(3)
      DEG=ACOS(-1.D0)/180.D0
      AK=(1.D0+SIN(PHI*DEG))/(1.D0-SIN(PHI*DEG))
      AM=(1.D0+SIN(PSI*DEG))/(1.D0-SIN(PSI*DEG))
      SC=2.D0*C*COS(PHI*DEG)/(1.D0-SIN(PHI*DEG))
      DO K=1,3
        S(K)=T(K)
      END DO
      F=AK*T(1)-T(3)-SC
      IF (F.LE.0.D0) RETURN
C     The plane.
      H=V*(AM-1.D0)/(1.D0-2.D0*V)
      A=F/(AK*(AM+H)-(H-1.D0))
      S(1)=T(1)-A*(AM+H)
      S(2)=T(2)-A*H
      S(3)=T(3)-A*(H-1.D0)
      IF (S(1).LT.S(2)) THEN
C       The edge S(1) = S(2).
        W=V/(1.D0+V)*(2.D0+AM)
        S(1)=((1.D0-W)*(T(1)+T(2))+(AM-W)*(T(3)+SC))/
     1   (2.D0*(1.D0-W)+(AM-W)*AK)
        S(2)=S(1)
        S(3)=AK*S(1)-SC
      ELSE IF (S(2).LT.S(3)) THEN
C       The edge S(2) = S(3).
        W=V/(1.D0+V)*(1.D0+2.D0*AM)
        S(1)=((1.D0-W)*T(1)+(AM-W)*(T(2)+T(3)+2.D0*SC))/
     1   ((1.D0-W)+2.D0*(AM-W)*AK)
        S(3)=AK*S(1)-SC
        S(2)=S(3)
      END IF
C     The apex, where the edge has left the order of the stresses.
      IF (PHI.GT.0.D0 .AND. S(1).GT.SC/(AK-1.D0)) THEN
        DO K=1,3
          S(K)=SC/(AK-1.D0)
        END DO
      END IF
      RETURN
      END
